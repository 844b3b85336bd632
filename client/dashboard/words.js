// Words for effects, techniques and numerical problems.

import { count, number, percent } from './format.js';

export const EFFECTS = {
  sun: 'Sun', sky: 'Sky', exterior: 'Light from exterior surfaces', caustics_mirror: 'Caustics of mirrors and lenses',
  caustics_bsdf: 'Caustics of BSDFs', caustics_glass: 'Direct sun through panes', interreflection: 'Interreflection',
  glossy: 'Glossy reflection', color: 'Colour', media: 'Absorption in solid glass', refraction: 'Refraction', lamps: 'Lamps',
  glare: 'Glare metrics', bins: 'Light by patch of sky', final_gather: 'Final gather', ports: 'Windows that emit photons',
  suns: 'Suns that emit photons',
};

export const TECHNIQUES = {
  backward: 'backward paths', gather: 'photon maps by final gather', direct: 'photon maps seen directly',
  precomputed: 'precomputed photons',
};

export const MAPS = {
  global: 'Global photons', caustic: 'Caustic photons', precomputed: 'Precomputed photons', bsdf: 'Loaded BSDF', scene: 'Loaded scene', annual: 'Light of a year', made: 'Computed BSDF', pilot: 'Pilot of photons',
};

// Largest error without an effect.
export function boundWords(bound) {
  if (!bound) return '';
  if (bound.value === null) return 'unbounded';
  if (bound.value === 0) return 'nothing is lost';
  return bound.unit === 'lx' ? `at most ${number(bound.value)}\u202flx` : `at most ${percent(bound.value)}`;
}

const HEALTH = [
  ['non_finite', (n) => `${n} were not finite and were left out`, 'values'],
  ['bsdf_clamped', (n, h) => `${n} of ${count(h.bsdf_values)} BSDF values were below zero and read as zero`],
  ['bsdf_rescaled', (n) => `${n} BSDF files scattered more light than they received and were scaled down`],
  ['degenerate', (n, h) => `${n} of ${count(h.surfaces)} surfaces have no area and were dropped`],
  ['photons_capped', (n, h) => `${n} of ${count(h.photons)} photons were cut off after too many bounces, ${percent(h.flux_capped_w / h.flux_w)} of the light`],
  ['paths_capped', (n, h) => `${n} of ${count(h.paths)} paths were cut off after too many bounces`],
  ['rays_leaked', (n, h) => `${n} of ${count(h.rays)} rays left a sealed scene without passing a window`],
  ['sparse_estimates', (n, h) => `${n} of ${count(h.estimates)} density estimates rest on fewer than 8 photons`],
];

// Returns {sound, lines, work}: problems, and the totals that they refer to.
export function healthWords(health) {
  const lines = HEALTH.filter(([name]) => health[name] > 0).map(([name, words]) => `${words(count(health[name]), health)}.`);
  const work = [health.rays && `${count(health.rays)} rays`, health.photons && `${count(health.photons)} photons`,
    health.surfaces && `${count(health.surfaces)} surfaces`].filter(Boolean).join(', ');
  return { sound: lines.length === 0, lines: lines.length ? lines : ['No numerical problems.'], work };
}

export const GOALS = (asked) => asked.dgp_error ? `DGP to \u00b1\u202f${number(asked.dgp_error)}` : percent(asked.relative_error);
