// Sorts sensors into the planes that contain them, each with axes for drawing.

// Rows of x y z dx dy dz from a job's document or its sensors.csv.
export function rowsOfCsv(text) {
  const [head, ...lines] = text.trim().split('\n');
  if (!head.startsWith('x,y,z,dx,dy,dz')) return [];
  return lines.map((line) => line.split(',').slice(0, 6).map(Number));
}

const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
function unit(a) {
  const length = Math.hypot(...a) || 1;
  return a.map((value) => value / length);
}

// Floors and ceilings are seen from above; walls from the side that the sensors face, upright.
function axesOf(normal) {
  if (Math.abs(normal[2]) > 0.9) return [[1, 0, 0], [0, 1, 0]];
  const across = unit(cross([0, 0, 1], normal));
  return [across, cross(normal, across)];
}

function faceWords(normal) {
  if (normal[2] > 0.9) return 'facing up';
  if (normal[2] < -0.9) return 'facing down';
  const compass = ['east', 'north-east', 'north', 'north-west', 'west', 'south-west', 'south', 'south-east'];
  const turn = Math.round(Math.atan2(normal[1], normal[0]) / (Math.PI / 4));
  return `facing ${compass[(turn + 8) % 8]}`;
}

// Borders of cells along an axis: half-way between neighbours. Scattered sensors (many distinct values)
// get squares of the smallest distance.
function edges(values, gridded) {
  const at = [...new Set(values.map((value) => Math.round(value * 1e4) / 1e4))].sort((a, b) => a - b);
  const gaps = at.slice(1).map((value, i) => value - at[i]);
  const least = gaps.length ? Math.min(...gaps) : 0;
  const before = (i) => (gridded && gaps[i - 1] ? gaps[i - 1] : gridded && gaps[i] ? gaps[i] : least) / 2;
  const behind = (i) => (gridded && gaps[i] ? gaps[i] : gridded && gaps[i - 1] ? gaps[i - 1] : least) / 2;
  return new Map(at.map((value, i) => [value, { i, from: value - before(i), to: value + behind(i) }]));
}

function cells(sensors) {
  const distinct = (key) => new Set(sensors.map((one) => Math.round(one[key] * 1e4))).size;
  const gridded = distinct('u') * distinct('v') <= 2 * sensors.length;
  const [us, vs] = ['u', 'v'].map((key) => edges(sensors.map((one) => one[key]), gridded));
  const of = (map, value) => map.get(Math.round(value * 1e4) / 1e4);
  const widest = Math.max(...[...us.values(), ...vs.values()].map(({ from, to }) => to - from)) || 0.5;
  // A single row or column gets cells of the usual size.
  const wide = ({ i, from, to }) => (to > from ? { i, from, to } : { i, from: from - widest / 2, to: to + widest / 2 });
  return sensors.map((one) => ({ ...one, across: wide(of(us, one.u)), along: wide(of(vs, one.v)) }));
}

// Returns [{name, sensors: [{index, place, across, along}], box: [u0, v0, u1, v1]}], the largest first.
export function planes(rows) {
  const found = new Map();
  rows.forEach((row, index) => {
    const normal = unit(row.slice(3, 6)), place = row.slice(0, 3);
    const level = dot(place, normal);
    const key = [...normal.map((value) => value.toFixed(2)), level.toFixed(2)].join();
    if (!found.has(key)) found.set(key, { normal, level, axes: axesOf(normal), sensors: [] });
    const plane = found.get(key);
    plane.sensors.push({ index, place, u: dot(place, plane.axes[0]), v: dot(place, plane.axes[1]) });
  });
  return [...found.values()].sort((a, b) => b.sensors.length - a.sensors.length).map((plane) => {
    const sensors = cells(plane.sensors);
    const end = (pick, of) => sensors.map(of).reduce((x, y) => pick(x, y));
    const height = Math.abs(plane.normal[2]) > 0.9 ? `, ${(plane.level * Math.sign(plane.normal[2])).toFixed(2)} high` : '';
    return {
      sensors, name: `${sensors.length} ${faceWords(plane.normal)}${height}`,
      box: [end(Math.min, (one) => one.across.from), end(Math.min, (one) => one.along.from), end(Math.max, (one) => one.across.to), end(Math.max, (one) => one.along.to)],
    };
  });
}

// Counts sensors at or above a threshold, with bounds from their 95 % intervals.
export function above(sensors, threshold) {
  let count = 0, low = 0, high = 0;
  for (const { illuminance_lx: value, interval_95_lx: interval } of sensors) {
    const [from, to] = [interval?.[0] ?? value, interval?.[1] ?? value];
    count += value >= threshold;
    low += from >= threshold;
    high += to >= threshold;
  }
  return { share: count / sensors.length, low: low / sensors.length, high: high / sensors.length, open: high - low };
}

export const isOpen = ({ interval_95_lx: interval }, threshold) => !!interval && interval[0] < threshold && interval[1] >= threshold;
