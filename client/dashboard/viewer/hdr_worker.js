// Fetches and decodes pictures in a worker. Input: {id, picture, errors}; output: the decoded picture, with
// the standard error of a pixel's luma, if known, as its fourth number.

import { decode, luma, survey } from './hdr.js';

async function fetchPicture(address) {
  const answer = await fetch(address, { cache: 'no-cache' });
  if (answer.ok) return decode(await answer.arrayBuffer());
  const problem = await answer.json().catch(() => ({}));
  throw new Error([problem.title, problem.detail].filter(Boolean).join(': ') || `HTTP ${answer.status}`);
}

onmessage = async ({ data: { id, picture, errors } }) => {
  try {
    const [found, spread] = await Promise.all([fetchPicture(picture), errors ? fetchPicture(errors).catch(() => null) : null]);
    const known = spread && spread.width === found.width && spread.height === found.height;
    const seen = survey(found.pixels);
    for (let i = 0; i < found.pixels.length; i += 4) found.pixels[i + 3] = known ? luma(spread.pixels, i) : 0;
    postMessage({ id, picture: { ...found, knowsErrors: !!known, ...seen } }, [found.pixels.buffer]);
  } catch (error) {
    postMessage({ id, fault: String(error.message || error) });
  }
};
