// The luminance of one pixel of a Radiance picture, read as pvalue does, apart from the page's reader.

export function luminance(bytes, x, y) {
  const text = new TextDecoder('latin1').decode(bytes);
  const [size, height, width] = /\n\n-Y (\d+) \+X (\d+)\n/.exec(text);
  const exposure = [...text.slice(0, text.indexOf(size)).matchAll(/^EXPOSURE=(.*)$/gm)].reduce((product, [, value]) => product * Number(value), 1);
  let at = text.indexOf(size) + size.length;
  const next = () => bytes[at++];
  let found = null;
  for (let line = 0; line <= y; line++) {
    if (next() !== 2 || next() !== 2 || (next() << 8) + next() !== Number(width)) throw new Error('a line that is not packed');
    found = [0, 1, 2, 3].map(() => {
      const run = [];
      while (run.length < Number(width)) {
        const code = next();
        if (code > 128) run.push(...new Array(code - 128).fill(next()));
        else for (let i = 0; i < code; i++) run.push(next());
      }
      return run[x];
    });
  }
  if (y >= Number(height)) throw new Error('no such line');
  const [red, green, blue] = found.slice(0, 3).map((value) => ((value + 0.5) / 256) * 2 ** (found[3] - 128));
  return (179 * (0.265074126 * red + 0.670114631 * green + 0.064811243 * blue)) / exposure;
}
