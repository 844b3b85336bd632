// Creates and changes elements without markup in strings.

function setProp(node, name, value) {
  if (name.startsWith('on')) node.addEventListener(name.slice(2), value);
  else if (name === 'class') node.className = value;
  else if (name in node && typeof value !== 'string' && !name.includes('-')) node[name] = value;
  else node.setAttribute(name, value === true ? '' : value);
}

// h('a', {href: '#'}, 'text', node, [nodes], null)
export function h(tag, props, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(props || {}))
    if (value !== null && value !== undefined && value !== false) setProp(node, name, value);
  node.append(...children.flat(Infinity).filter((one) => one !== null && one !== undefined && one !== false));
  return node;
}

const SVG = 'http://www.w3.org/2000/svg';
export function svg(tag, props, ...children) {
  const node = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(props || {})) node.setAttribute(name, value);
  node.append(...children.flat());
  return node;
}

// Nodes are written only if they change, to keep selections, focus and screen readers undisturbed.
export function setText(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

export function setAttr(node, name, value) {
  if (value === null || value === undefined) node.removeAttribute(name);
  else if (node.getAttribute(name) !== String(value)) node.setAttribute(name, value);
}

// Rebuilds the contents of node with build() if `depends` has changed since the last call.
const keys = new WeakMap();
export function fill(node, depends, build) {
  const key = JSON.stringify(depends);
  if (keys.get(node) === key) return;
  keys.set(node, key);
  const made = build();
  node.replaceChildren(...[made].flat(Infinity).filter((one) => one !== null && one !== undefined && one !== false));
}

// Announces a change to screen readers.
export function say(text) {
  document.getElementById('said').textContent = text;
}
