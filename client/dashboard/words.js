// Effects of light, techniques and what went wrong in numbers, for people.

import { count, number, percent } from './format.js';

export const EFFECTS = {
  sun: 'Sun', sky: 'Sky', exterior: 'Light by way of surfaces outside', caustics_mirror: 'Caustics of mirrors and lenses',
  caustics_bsdf: 'Caustics of BSDFs', caustics_glass: 'Sun straight through panes', interreflection: 'Interreflection',
  glossy: 'Glossy reflection', color: 'Colour', media: 'Absorption in solid glass', refraction: 'Refraction', lamps: 'Lamps',
  glare: 'Glare metrics', bins: 'Light by patch of sky', final_gather: 'Final gather', ports: 'Windows that send photons',
  suns: 'Suns that send photons',
};

export const TECHNIQUES = {
  backward: 'backward paths', gather: 'photon maps by final gather', direct: 'photon maps seen directly',
  precomputed: 'precomputed photons',
};

export const MAPS = {
  global: 'Global photons', caustic: 'Caustic photons', precomputed: 'Precomputed photons', bsdf: 'Loaded BSDF', scene: 'Loaded scene', annual: 'Light of a year', made: 'BSDF made of geometry',
};

// What leaving an effect out costs at most.
export function boundWords(bound) {
  if (!bound) return '';
  if (bound.value === null) return 'unbounded';
  if (bound.value === 0) return 'nothing is lost';
  return bound.unit === 'lx' ? `at most ${number(bound.value)}\u202flx` : `at most ${percent(bound.value)}`;
}

const HEALTH = [
  ['non_finite', (n) => `${n} were no finite number and left out`, 'values'],
  ['bsdf_clamped', (n, h) => `${n} of ${count(h.bsdf_values)} BSDF values were below zero and read as zero`],
  ['bsdf_rescaled', (n) => `${n} BSDF files gave back more light than they got, and were scaled down`],
  ['degenerate', (n, h) => `${n} of ${count(h.surfaces)} surfaces have no area and were dropped`],
  ['photons_capped', (n, h) => `${n} of ${count(h.photons)} photons were given up after too many bounces, ${percent(h.flux_capped_w / h.flux_w)} of the light`],
  ['paths_capped', (n, h) => `${n} of ${count(h.paths)} paths were given up after too many bounces`],
  ['rays_leaked', (n, h) => `${n} of ${count(h.rays)} rays left a sealed scene without passing a window`],
  ['sparse_estimates', (n, h) => `${n} of ${count(h.estimates)} density estimates rest on fewer than 8 photons`],
];

// {sound, lines}: what went wrong, and what all of it was out of.
export function healthWords(health) {
  const lines = HEALTH.filter(([name]) => health[name] > 0).map(([name, words]) => `${words(count(health[name]), health)}.`);
  const work = [health.rays && `${count(health.rays)} rays`, health.photons && `${count(health.photons)} photons`,
    health.surfaces && `${count(health.surfaces)} surfaces`].filter(Boolean).join(', ');
  return { sound: lines.length === 0, lines: lines.length ? lines : ['Nothing went wrong in numbers.'], work };
}

export const GOALS = (asked) => asked.dgp_error ? `DGP to \u00b1\u202f${number(asked.dgp_error)}` : percent(asked.relative_error);
