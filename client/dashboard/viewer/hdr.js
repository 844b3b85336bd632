// Decodes Radiance pictures (RGBE) to floats: W/sr/m2 in Radiance's RGB, without the file's exposure.

// Weights and efficacy of Radiance (core/include/oriel/base/units.h).
export const LUMA = [0.265074126, 0.670114631, 0.064811243];
export const EFFICACY = 179;

function readHeader(bytes) {
  const header = { exposure: 1, view: '', at: 0 };
  const decoder = new TextDecoder('latin1');
  const line = () => {
    const end = bytes.indexOf(10, header.at);
    if (end < 0) throw new Error('the header of the picture has no end');
    const text = decoder.decode(bytes.subarray(header.at, end));
    header.at = end + 1;
    return text;
  };
  if (!line().startsWith('#?')) throw new Error('this is not a Radiance picture');
  for (let text = line(); text !== ''; text = line()) {
    if (text.startsWith('EXPOSURE=')) header.exposure *= parseFloat(text.slice(9));
    if (text.startsWith('VIEW=')) header.view = text.slice(5);
    if (text.startsWith('FORMAT=') && text.slice(7).trim() !== '32-bit_rle_rgbe') throw new Error(`the picture's format ${text.slice(7)} is not supported`);
  }
  const size = /^-Y (\d+) \+X (\d+)$/.exec(line());
  if (!size) throw new Error('the picture is rotated or mirrored, or its size is missing');
  return Object.assign(header, { height: Number(size[1]), width: Number(size[2]) });
}

// Decodes one line of RGBE, new or old encoding, into row. Returns the offset of the next line.
function readRow(bytes, at, width, row) {
  const packed = width >= 8 && width < 32768 && bytes[at] === 2 && bytes[at + 1] === 2 && (bytes[at + 2] << 8 | bytes[at + 3]) === width;
  if (!packed) return readOldRow(bytes, at, width, row);
  at += 4;
  for (let c = 0; c < 4; c++)
    for (let x = 0; x < width;) {
      const code = bytes[at++];
      if (code === undefined) throw new Error('the picture is truncated');
      if (code > 128) {
        const value = bytes[at++];
        for (let i = code & 127; i > 0 && x < width; i--, x++) row[4 * x + c] = value;
      } else {
        for (let i = code; i > 0 && x < width; i--, x++) row[4 * x + c] = bytes[at++];
      }
    }
  return at;
}

// Pixel by pixel; 1 1 1 n repeats the previous pixel.
function readOldRow(bytes, at, width, row) {
  for (let x = 0, shift = 0; x < width;) {
    if (at + 4 > bytes.length) throw new Error('the picture is truncated');
    if (x > 0 && bytes[at] === 1 && bytes[at + 1] === 1 && bytes[at + 2] === 1) {
      for (let i = bytes[at + 3] << shift; i > 0 && x < width; i--, x++) row.copyWithin(4 * x, 4 * x - 4, 4 * x);
      shift += 8;
    } else {
      row.set(bytes.subarray(at, at + 4), 4 * x++);
      shift = 0;
    }
    at += 4;
  }
  return at;
}

// Returns {width, height, view, pixels}: four floats per pixel, the fourth 0, top row first.
export function decode(buffer) {
  const bytes = new Uint8Array(buffer);
  const { width, height, view, exposure, at: start } = readHeader(bytes);
  const pixels = new Float32Array(4 * width * height), row = new Uint8Array(4 * width);
  for (let y = 0, at = start; y < height; y++) {
    at = readRow(bytes, at, width, row);
    for (let x = 0, out = 4 * width * y; x < width; x++, out += 4) {
      const e = row[4 * x + 3];
      if (e === 0) continue;
      const scale = 2 ** (e - 136) / exposure;
      pixels[out] = (row[4 * x] + 0.5) * scale;
      pixels[out + 1] = (row[4 * x + 1] + 0.5) * scale;
      pixels[out + 2] = (row[4 * x + 2] + 0.5) * scale;
    }
  }
  return { width, height, view, pixels };
}

export const luma = (pixels, i) => LUMA[0] * pixels[i] + LUMA[1] * pixels[i + 1] + LUMA[2] * pixels[i + 2];

// Statistics for scales: the geometric mean of lit pixels, and the 99th percentile.
export function survey(pixels) {
  const values = new Float32Array(pixels.length / 4);
  let logs = 0, lit = 0;
  for (let i = 0; i < values.length; i++) {
    values[i] = luma(pixels, 4 * i);
    if (values[i] > 0) {
      logs += Math.log(values[i]);
      lit++;
    }
  }
  values.sort();
  return { mean: lit ? Math.exp(logs / lit) : 1, high: values[values.length - 1 - Math.floor((values.length - 1) / 100)] || 1 };
}
