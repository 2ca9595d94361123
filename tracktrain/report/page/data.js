// The run's numbers: unpacked once, then read by name.

const known = JSON.parse(document.getElementById("known").textContent);

async function inflated(id) {
  const text = atob(document.getElementById(id).textContent);
  const octets = Uint8Array.from(text, (letter) => letter.charCodeAt(0));
  const stream = new Blob([octets]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
}

// Every array as {data, shape}; bytes of equal weight stand together in the file.
async function unpacked() {
  const planes = new Uint8Array(await inflated("arrays"));
  const count = planes.length / 4;
  const octets = new Uint8Array(planes.length);
  for (let plane = 0; plane < 4; plane++)
    for (let i = 0; i < count; i++) octets[4 * i + plane] = planes[plane * count + i];
  const numbers = new Float32Array(octets.buffer);
  const arrays = {};
  for (const [name, { start, shape }] of Object.entries(known.arrays))
    arrays[name] = { shape, data: numbers.subarray(start, start + shape.reduce((a, b) => a * b)) };
  return arrays;
}

function row(array, number) {
  const width = array.data.length / array.shape[0];
  return array.data.subarray(number * width, (number + 1) * width);
}

function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}
