// The order in which chosen files are read: a name must be defined before it is used.
// Without a choice, the daemon decides which files are the main files.

const SURFACES = new Set(['polygon', 'sphere', 'bubble', 'cone', 'cup', 'cylinder', 'tube', 'ring', 'instance', 'mesh', 'source']);

// Returns {defines, uses, files} of a scene file: names of modifiers, and files that its commands read.
export function scan(text) {
  const found = { defines: new Set(), uses: new Set(), files: new Set() };
  const commands = [];
  const plain = text.replace(/^[ \t]*!((?:.*\\\r?\n)*.*)$/gm, (_, command) => { commands.push(command); return ''; }).replace(/#.*$/gm, '');
  for (const command of commands) {
    for (const [, name] of command.matchAll(/(\S+\.rad)\b/g)) found.files.add(name.replace(/^\.\//, ''));
    for (const [, name] of command.matchAll(/\s-m\s+(\S+)/g)) found.uses.add(name);
    const generated = /^\s*(?:genbox|gensurf|genworm|genrev|genprism)\s+(\S+)/.exec(command);
    if (generated) found.uses.add(generated[1]);
  }
  const words = plain.split(/\s+/).filter(Boolean);
  for (let at = 0; at + 2 < words.length;) {
    const [modifier, type, name] = words.slice(at, at + 3);
    if (modifier !== 'void' && !found.defines.has(modifier)) found.uses.add(modifier);
    if (!SURFACES.has(type)) found.defines.add(name);
    at += 3;
    if (type === 'alias') {
      if (!found.defines.has(words[at])) found.uses.add(words[at]);
      at += 1;
    } else for (let list = 0; list < 3 && at < words.length; list++) at += 1 + (Number(words[at]) || 0);
  }
  return found;
}

// Sorts files ({name, scan}) so that definitions come before uses; else by name.
export function ordered(files) {
  const left = [...files].sort((a, b) => (a.name < b.name ? -1 : 1)), done = [];
  const needs = (one, other) => one !== other && [...one.scan.uses].some((name) => other.scan.defines.has(name) && !one.scan.defines.has(name));
  while (left.length) {
    const next = left.findIndex((one) => !left.some((other) => needs(one, other)));
    done.push(...left.splice(Math.max(0, next), 1));
  }
  return done.map(({ name }) => name);
}

// texts: Map of name to text of the top-level scene files. Material files (.mat) are main files if they
// define names that no other file defines.
// Returns {files: list of {name, scan}, all: possible main files, in order}.
export function candidates(texts) {
  const files = [...texts].map(([name, text]) => ({ name, scan: scan(text) }));
  const named = files.filter(({ name }) => !files.some((other) => other.scan.files.has(name)));
  const mains = named.filter(({ name }) => !/\.mat$/i.test(name));
  const wants = (word) => mains.some(({ scan: one }) => one.uses.has(word)) && !mains.some(({ scan: one }) => one.defines.has(word));
  for (let taken = true; taken;) {
    taken = named.find((one) => !mains.includes(one) && [...one.scan.defines].some(wants));
    if (taken) mains.push(taken);
  }
  return { files, all: ordered(mains) };
}
