// Dropped or chosen files as the body of an upload: a zip or a Honeybee model unchanged, anything else
// as a zip.

import { candidates } from './mains.js';
import { zip } from './zip.js';

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

// A model with the other files, such as weather.
async function withFiles(model, others) {
  const files = [];
  for (const { name, file } of others) {
    const bytes = new Uint8Array(await file.arrayBuffer());
    let text = '';
    for (let i = 0; i < bytes.length; i += 0x8000) text += String.fromCharCode(...bytes.subarray(i, i + 0x8000));
    files.push({ name: name.split('/').pop(), base64: btoa(text) });
  }
  const body = new Blob([`{"model": ${await model.file.text()}, "files": ${JSON.stringify(files)}}`]);
  return { body, type: 'application/json', names: files.map(({ name }) => name), mains: null };
}

// Returns {body, type, names, mains}. names: as in the scene, without a common folder; mains: candidates
// (mains.js), or null for a zip or a model.
export async function upload(found) {
  if (found.length === 1 && /\.zip$/i.test(found[0].name)) return { body: found[0].file, type: 'application/zip', names: [], mains: null };
  if (found.length === 1 && /\.(hbjson|json)$/i.test(found[0].name)) return { body: found[0].file, type: 'application/json', names: [], mains: null };
  const models = found.filter(({ name }) => /\.hbjson$/i.test(name)), others = found.filter((one) => !models.includes(one));
  if (models.length === 1 && !others.some(({ name }) => /\.rad$/i.test(name))) return withFiles(models[0], others);
  const files = [];
  for (const { name, file } of found) files.push({ name, bytes: new Uint8Array(await file.arrayBuffer()) });
  const top = files[0].name.split('/')[0];
  const inOne = files.every(({ name }) => name.startsWith(`${top}/`));
  const named = files.map(({ name, bytes }) => [inOne ? name.slice(top.length + 1) : name, bytes]);
  const decoder = new TextDecoder('latin1');
  const texts = new Map(named.filter(([name]) => /^[^/]+\.(rad|mat)$/i.test(name)).map(([name, bytes]) => [name, decoder.decode(bytes)]));
  return { body: zip(files), type: 'application/zip', names: named.map(([name]) => name), mains: candidates(texts) };
}
