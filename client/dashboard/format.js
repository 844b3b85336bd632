// Formats numbers, times and states.

const whole = new Intl.NumberFormat('en', { maximumFractionDigits: 0 });
const NONE = '\u2013';

export const count = (value) => (Number.isFinite(value) ? whole.format(value).replace(/,/g, '\u202f') : NONE);

// Formats with that many significant digits, without exponents for ordinary quantities.
export function number(value, digits = 3) {
  if (!Number.isFinite(value)) return NONE;
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size >= 10 ** digits) return count(value);
  if (size < 1e-4) return value.toExponential(digits - 1);
  return Number(value.toPrecision(digits)).toString();
}

export function percent(fraction, digits = 2) {
  return Number.isFinite(fraction) ? `${number(100 * fraction, digits)}\u202f%` : NONE;
}

export function duration(seconds) {
  if (!Number.isFinite(seconds)) return NONE;
  if (seconds < 0.01) return '<\u202f10\u202fms';
  if (seconds < 1) return `${Math.round(1000 * seconds)}\u202fms`;
  if (seconds < 10) return `${seconds.toFixed(1)}\u202fs`;
  if (seconds < 60) return `${Math.round(seconds)}\u202fs`;
  const together = (large, small) => [large, small].filter((one) => !/^0/.test(one)).join(' ');
  const whole = Math.round(seconds), minutes = Math.floor(whole / 60);
  if (minutes < 10) return together(`${minutes}\u202fmin`, `${whole % 60}\u202fs`);
  if (minutes < 60) return `${Math.round(seconds / 60)}\u202fmin`;
  const hours = Math.floor(minutes / 60);
  if (hours < 48) return together(`${hours}\u202fh`, `${minutes % 60}\u202fmin`);
  return `${Math.round(hours / 24)} days`;
}

export function bytes(size) {
  const units = ['B', 'kB', 'MB', 'GB', 'TB'];
  let at = 0;
  for (; size >= 999.5 && at + 1 < units.length; at++) size /= 1000;
  return `${at === 0 ? size : number(size, 3)}\u202f${units[at]}`;
}

const clock = new Intl.DateTimeFormat('en-GB', { hour: '2-digit', minute: '2-digit' });
const day = new Intl.DateTimeFormat('en-GB', { day: 'numeric', month: 'short' });
const long = new Intl.DateTimeFormat('en-GB', { dateStyle: 'medium', timeStyle: 'medium' });

// "17:02" for today, "3 Nov, 17:02" for other days.
export function moment(text) {
  if (!text) return NONE;
  const when = new Date(text);
  const today = when.toDateString() === new Date().toDateString();
  return today ? clock.format(when) : `${day.format(when)}, ${clock.format(when)}`;
}
export const fullMoment = (text) => (text ? long.format(new Date(text)) : '');

export const shortId = (id) => id.slice(0, 8);
export const jobName = (job) => job.name || `Job ${shortId(job.id)}`;

const STATES = {
  queued: 'Waiting', running: 'Running', cancelling: 'Stopping', succeeded: 'Succeeded', failed: 'Failed',
  cancelled: 'Cancelled',
};
export const stateName = (state) => STATES[state] || state;
export const isOver = (state) => state === 'succeeded' || state === 'failed' || state === 'cancelled';

const STAGES = {
  load: 'Reading', bvh: 'Building BVH', plan: 'Planning', photons: 'Photons', maps: 'Maps', render: 'Rendering',
  skies: 'Skies', paths: 'Paths', sun: 'Sun', hours: 'Hours', reference: 'Reference',
};
export const stageName = (stage) => STAGES[stage] || (stage ? stage[0].toUpperCase() + stage.slice(1) : '');
export { NONE };
