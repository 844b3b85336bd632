// Dropped or chosen files as one upload.

import { Bundle } from '../oriel.js';
import { candidates } from './mains.js';

async function filesOf(entry, path) {
  if (entry.isFile) return [{ name: path + entry.name, file: await new Promise((resolve, reject) => entry.file(resolve, reject)) }];
  const reader = entry.createReader(), found = [];
  for (;;) {
    const some = await new Promise((resolve, reject) => reader.readEntries(resolve, reject));
    if (!some.length) break;
    for (const one of some) found.push(...await filesOf(one, `${path}${entry.name}/`));
  }
  return found;
}

// Files of a drop. Entries must be requested before the first await.
export async function ofDrop(transfer) {
  const entries = [...transfer.items].map((item) => item.webkitGetAsEntry?.()).filter(Boolean);
  if (!entries.length) return ofChoice(transfer.files);
  return (await Promise.all(entries.map((entry) => filesOf(entry, '')))).flat();
}

export const ofChoice = (files) => [...files].map((file) => ({ name: file.webkitRelativePath || file.name, file }));

// Returns {bundle, mains}. mains: candidates for main files (mains.js), or null for a zip or a model.
export async function bundleOf(found) {
  const bundle = await Bundle.of(found);
  if (bundle.type !== 'application/zip' || !bundle.names.length) return { bundle, mains: null };
  const texts = new Map();
  for (const [i, name] of bundle.names.entries())
    if (/^[^/]+\.(rad|mat)$/i.test(name)) texts.set(name, new TextDecoder('latin1').decode(await found[i].file.arrayBuffer()));
  return { bundle, mains: candidates(texts) };
}
