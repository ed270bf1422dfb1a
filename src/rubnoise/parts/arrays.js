/* What the pages of lessons, runs and sweeps share: arrays in text form, places in them, Fourier sums, elements.
 * Each file of a page is a function of its own (web_page.py); what others need of it stands in rub.
 */
globalThis.rub ??= {};
const TYPES = {
  f8: Float64Array,
  f4: Float32Array,
  i8: BigInt64Array,
  u8: BigUint64Array,
  i4: Int32Array,
  u4: Uint32Array,
  u2: Uint16Array,
  i2: Int16Array,
  u1: Uint8Array,
  i1: Int8Array,
};

/** Return the array that a page holds as its type and its bytes, lowest first, in base 64; whole numbers as doubles. */
function unpacked({ type, bytes }) {
  const text = atob(bytes);
  const raw = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i += 1) raw[i] = text.charCodeAt(i);
  const values = new TYPES[type](raw.buffer);
  return type.endsWith('8') && type !== 'f8' ? Float64Array.from(values, Number) : values;
}

/** Return the first of so many places for which something holds that holds for all after it too. */
function firstPlace(count, holds) {
  let low = 0;
  let high = count;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (holds(middle)) high = middle;
    else low = middle + 1;
  }
  return low;
}

/** Return the first place in an ascending array whose value is at least so large. */
const firstAtLeast = (values, wanted) => firstPlace(values.length, (i) => values[i] >= wanted);

/** Return the value at a place between two of an array, by a straight line. */
function between(values, place) {
  const i = Math.max(0, Math.min(Math.floor(place), values.length - 2));
  return values[i] + (place - i) * (values[i + 1] - values[i]);
}

/** Replace complex numbers by their Fourier sums, in place; sign -1 forward, +1 back (times their number). */
function fourier(real, imaginary, sign = -1) {
  const count = real.length;
  for (let i = 1, j = 0; i < count; i += 1) {
    let bit = count >> 1;
    for (; j & bit; bit >>= 1) j ^= bit;
    j ^= bit;
    if (i < j) {
      [real[i], real[j]] = [real[j], real[i]];
      [imaginary[i], imaginary[j]] = [imaginary[j], imaginary[i]];
    }
  }
  for (let length = 2; length <= count; length *= 2) butterflies(real, imaginary, length, sign);
}

function butterflies(real, imaginary, length, sign) {
  const half = length / 2;
  for (let k = 0; k < half; k += 1) {
    const [c, s] = [Math.cos((2 * Math.PI * k) / length), sign * Math.sin((2 * Math.PI * k) / length)];
    for (let i = k; i < real.length; i += length) {
      const j = i + half;
      const [x, y] = [real[j] * c - imaginary[j] * s, real[j] * s + imaginary[j] * c];
      [real[j], imaginary[j]] = [real[i] - x, imaginary[i] - y];
      [real[i], imaginary[i]] = [real[i] + x, imaginary[i] + y];
    }
  }
}

/** Welch's estimate of a two-sided spectral density, as the commands make it: Hann segments of so many ticks. */
class Welch {
  constructor(ticks) {
    this.window = Float64Array.from({ length: ticks }, (_, i) => Math.sin((Math.PI * i) / ticks) ** 2);
    this.energy = this.window.reduce((sum, w) => sum + w * w, 0);
    this.sums = new Float64Array(ticks / 2 + 1);
    this.segments = 0;
  }

  /** Take in a segment, about a mean. */
  add(values, mean) {
    const real = this.window.map((w, i) => w * (values[i] - mean));
    const imaginary = new Float64Array(real.length);
    fourier(real, imaginary);
    for (let bin = 0; bin < this.sums.length; bin += 1) this.sums[bin] += real[bin] ** 2 + imaginary[bin] ** 2;
    this.segments += 1;
  }

  /** Return the density by bin where ticks are a step apart. */
  density(step) {
    return this.sums.map((sum) => (sum * step) / this.energy / this.segments);
  }
}

/** Return a new element with attributes (text: its text, html: its content, on...: what is called) and children. */
function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name === 'text') element.textContent = value;
    else if (name === 'html') element.innerHTML = value;
    else if (typeof value === 'function') element.addEventListener(name.slice(2), value);
    else if (value !== false && value !== undefined) element.setAttribute(name, value === true ? '' : value);
  }
  element.append(...children.filter(Boolean));
  return element;
}

/** Let a pointer that is down on an element be followed: down returns whether it is, and move is called on the way. */
function dragging(element, down, move) {
  let isHeld = false;
  element.addEventListener('pointerdown', (event) => {
    isHeld = down(event) !== false;
    if (isHeld) event.target.setPointerCapture(event.pointerId);
  });
  element.addEventListener('pointermove', (event) => isHeld && move(event));
  for (const name of ['pointerup', 'pointercancel']) {
    element.addEventListener(name, () => {
      isHeld = false;
    });
  }
}

Object.assign(rub, { unpacked, firstPlace, firstAtLeast, between, fourier, Welch, make, dragging });
