// The order in which files that somebody picks are read: a name has to be defined before it is used.
// Which files make the scene the service says, as long as nobody picks any.

const SURFACES = new Set(['polygon', 'sphere', 'bubble', 'cone', 'cup', 'cylinder', 'tube', 'ring', 'instance', 'mesh', 'source']);

// {defines, uses, files} of a scene file's text: names of modifiers, and what its commands read.
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

// Files (of {name, scan}) so that what one uses stands in one before it; else by name.
export function ordered(files) {
  const left = [...files].sort((a, b) => (a.name < b.name ? -1 : 1)), done = [];
  const needs = (one, other) => one !== other && [...one.scan.uses].some((name) => other.scan.defines.has(name) && !one.scan.defines.has(name));
  while (left.length) {
    const next = left.findIndex((one) => !left.some((other) => needs(one, other)));
    done.push(...left.splice(Math.max(0, next), 1));
  }
  return done.map(({ name }) => name);
}

// texts: Map of name to text, of the scene files at the top; those of materials (.mat) are some where they
// define what no other does.
// {files: of {name, scan}, all: what may be a main file, in order}
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
