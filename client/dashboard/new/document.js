// The job document that a form describes.

const number = (form, name) => Number(form.get(name));
const filled = (form, name) => String(form.get(name) || '').trim();

function moment(form) {
  const [month, day] = filled(form, 'date').split('-').slice(-2).map(Number);
  const [hours, minutes] = filled(form, 'time').split(':').map(Number);
  return { month, day, hour: hours + minutes / 60 };
}

const place = (form) => ({ latitude: number(form, 'latitude'), longitude: number(form, 'longitude'), time_zone: number(form, 'zone') });

const SKIES = {
  own: () => null,
  overcast: (form) => ({ cie: { type: 'overcast', diffuse_horizontal_lx: number(form, 'diffuse') } }),
  clear: (form) => ({ cie: { type: 'clear', ...moment(form), ...place(form) } }),
  perez: (form) => ({ perez: { ...moment(form), ...place(form), direct_normal_w_m2: number(form, 'direct_w'), diffuse_horizontal_w_m2: number(form, 'diffuse_w') } }),
  weather: (form) => ({ weather: { file: filled(form, 'weather'), ...moment(form) } }),
};

// Sensors on a grid over a rectangle, half a spacing from its edges, facing up.
export function gridOf(form) {
  const [left, right, low, high, spacing, height] = ['left', 'right', 'low', 'high', 'spacing', 'height'].map((name) => number(form, name));
  const rows = [];
  if (!(spacing > 0)) return rows;
  for (let y = low + spacing / 2; y < high - spacing / 4; y += spacing)
    for (let x = left + spacing / 2; x < right - spacing / 4; x += spacing)
      rows.push([...[x, y, height].map((value) => Number(value.toFixed(4))), 0, 0, 1]);
  return rows;
}

function sensors(form) {
  const kind = form.get('sensors');
  if (kind === 'grid') return gridOf(form);
  if (kind === 'rows') return filled(form, 'rows').split('\n').filter((line) => line.trim() && !line.startsWith('#')).map((line) => line.trim().split(/[\s,;]+/).map(Number));
  return null;
}

// project: the summary of a Honeybee model.
function views(form, project) {
  const size = { width: number(form, 'width'), height: number(form, 'view_height') };
  const kind = form.get('views');
  if (kind === 'project') return project.views.map((view) => ({ ...view, ...size }));
  return kind === 'own' ? [{ name: filled(form, 'view_name'), view: filled(form, 'view'), ...size }] : null;
}

export function documentOf(form, scene) {
  const document = { kind: 'render', scene: scene.id };
  const { project } = scene.summary;
  const sky = SKIES[form.get('sky')](form);
  const found = sensors(form), asked = views(form, project);
  const tags = filled(form, 'tags').split(',').map((tag) => tag.trim()).filter(Boolean);
  if (filled(form, 'name')) document.name = filled(form, 'name');
  if (tags.length) document.tags = tags;
  if (sky) document.sky = sky;
  if (found) document.sensors = found;
  if (form.get('sensors') === 'project') document.grids = project.grids;
  if (asked) document.views = asked;
  document.accuracy = form.get('goal') === 'error' ? { relative_error: number(form, 'error') / 100 } : { deadline_s: number(form, 'deadline') };
  return document;
}
