// Reads the run that the page holds: a description in JSON, and arrays in base64 and zlib. How the
// arrays are coded is described in lib/player/data_block.hpp.

// The bytes of the arrays, unpacked piece by piece so that only one copy of them is in memory.
async function unpackedBytes(text, size) {
  let at = 0;
  const part = 1 << 20;  // a multiple of four characters, which stand for three bytes
  const packed = new ReadableStream({
    pull(controller) {
      if (at >= text.length) return controller.close();
      const binary = atob(text.slice(at, at + part));
      const piece = new Uint8Array(binary.length);
      for (let i = 0; i < binary.length; ++i) piece[i] = binary.charCodeAt(i);
      at += part;
      controller.enqueue(piece);
    }
  });
  const bytes = new Uint8Array(size);
  let filled = 0;
  const reader = packed.pipeThrough(new DecompressionStream('deflate')).getReader();
  for (;;) {
    const {done, value} = await reader.read();
    if (done) break;
    bytes.set(value, filled);
    filled += value.length;
  }
  if (filled !== size) throw new Error(`the data block has ${filled} bytes in place of ${size}`);
  return bytes;
}

// Puts numbers together from their bytes, of which those at one place of all numbers stand
// together. The bytes that are not there are zero: the highest of integers, the lowest of floats.
function fromPlanes(bytes, offset, array) {
  const words = new Uint32Array(array.count);
  for (let plane = 0; plane < array.planes; ++plane) {
    const shift = array.type === 'float' ? 24 - 8 * plane : 8 * plane;
    const first = offset + plane * array.count;
    for (let i = 0; i < array.count; ++i) words[i] |= bytes[first + i] << shift;
  }
  return words;
}

// Integers are stored as the difference to the one `period` places before, and as 0, -1, 1, -2, 2,
// ... so that small ones have few bytes.
function decodedIntegers(words, period) {
  const values = new Int32Array(words.length);
  for (let i = 0; i < words.length; ++i) {
    const difference = (words[i] >>> 1) ^ -(words[i] & 1);
    values[i] = period > 0 && i >= period ? values[i - period] + difference : difference;
  }
  return values;
}

async function readRun() {
  const run = JSON.parse(document.getElementById('description').textContent);
  const text = document.getElementById('data').textContent.trim();
  const bytes = await unpackedBytes(text, run.bytes);
  document.getElementById('data').remove();
  run.array = {};
  let offset = 0;
  for (const array of run.arrays) {
    const words = fromPlanes(bytes, offset, array);
    run.array[array.name] = array.type === 'float' ? new Float32Array(words.buffer)
                                                   : decodedIntegers(words, array.period);
    offset += array.planes * array.count;
  }
  run.frames = run.times.length;
  run.items = run.bodies.length + run.elements;  // what has values: bodies, then elements
  return run;
}

// Numbers as people write them: four digits, a power of ten where there would be many zeros.
function shortNumber(value, digits = 4) {
  if (!Number.isFinite(value)) return '–';
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-3) {
    const [mantissa, power] = value.toExponential(digits - 1).split('e');
    return `${Number(mantissa)}e${Number(power)}`.replace('-', '−').replace('e-', 'e−');
  }
  return String(Number(value.toPrecision(digits))).replace('-', '−');
}

// So many digits tell the values between `low` and `high` apart.
function digitsBetween(low, high) {
  const size = Math.max(Math.abs(low), Math.abs(high));
  return Math.min(15, Math.max(4, Math.ceil(Math.log10(size / (high - low))) + 3)) || 4;
}

// About `count` round numbers from `low` to `high`, for axes.
function ticks(low, high, count) {
  const raw = (high - low) / Math.max(1, count);
  if (!(raw > 0)) return [low];
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map(m => m * power).find(s => s >= raw * 0.999);
  const result = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i) {
    result.push(i === 0 ? 0 : i * step);
  }
  return result;
}
