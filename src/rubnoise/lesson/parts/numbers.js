/* Numerical tools: quadrature, interpolation, the normal law. Nothing here knows of junctions. */
const { firstAtLeast } = rub;
const rules = new Map();

/** Return Gauss-Legendre nodes x and weights w on [-1, 1], by Newton's method on the Legendre polynomial. */
function gauss(count) {
  if (!rules.has(count)) rules.set(count, newRule(count));
  return rules.get(count);
}

function newRule(count) {
  const x = new Float64Array(count);
  const w = new Float64Array(count);
  for (let i = 0; i < count; i += 1) {
    let z = Math.cos((Math.PI * (i + 0.75)) / (count + 0.5));
    let slope = 1;
    for (let turn = 0; turn < 8; turn += 1) {
      const [value, derivative] = legendre(count, z);
      slope = derivative;
      z -= value / derivative;
    }
    slope = legendre(count, z)[1];
    x[i] = -z;
    w[i] = 2 / ((1 - z * z) * slope * slope);
  }
  return { x, w };
}

function legendre(count, z) {
  let before = 1;
  let value = z;
  for (let n = 2; n <= count; n += 1) [before, value] = [value, ((2 * n - 1) * z * value - (n - 1) * before) / n];
  return [value, (count * (z * value - before)) / (z * z - 1)];
}

/**
 * Return nodes and weights of a Gauss rule on every panel between rising edges. A rooted rule takes
 * x = a + (b - a) t^2 (3 - 2t), which makes roots such as (x - a)^1.5 smooth at both ends of a panel.
 */
function panels(edges, count, rooted = false) {
  const { x, w } = gauss(count);
  const nodes = new Float64Array(count * (edges.length - 1));
  const weights = new Float64Array(nodes.length);
  for (let panel = 0, i = 0; panel + 1 < edges.length; panel += 1) {
    const width = edges[panel + 1] - edges[panel];
    for (let j = 0; j < count; j += 1, i += 1) {
      const t = 0.5 * (1 + x[j]);
      nodes[i] = edges[panel] + width * (rooted ? t * t * (3 - 2 * t) : t);
      weights[i] = 0.5 * w[j] * width * (rooted ? 6 * t * (1 - t) : 1);
    }
  }
  return { nodes, weights };
}

/** Return edges of so many equal panels from low to high. */
function evenly(low, high, count) {
  return Array.from({ length: count + 1 }, (_, i) => low + ((high - low) * i) / count);
}

/** Return where between 0 and an end something ceases to hold, by halving. */
function lastWhere(holds, end) {
  let [low, high] = [0, end];
  for (let i = 0; i < 60; i += 1) {
    const middle = 0.5 * (low + high);
    if (holds(middle)) low = middle;
    else high = middle;
  }
  return low;
}

/** Return numbers in order without repetition (and without gaps too narrow to matter). */
function ordered(values) {
  const sorted = [...values].sort((a, b) => a - b);
  const least = 1e-13 * Math.abs(sorted[sorted.length - 1]);
  return sorted.filter((value, i) => i === 0 || value - sorted[i - 1] > least);
}

/** Return the sum of Chebyshev polynomials on [low, high] as a function, after Clenshaw. */
function series(c, low, high) {
  const middle = 0.5 * (low + high);
  const scale = 4 / (high - low);
  return (at) => {
    const y = scale * (at - middle);
    let one = 0;
    let two = 0;
    for (let n = c.length - 1; n > 0; n -= 1) [one, two] = [y * one - two + c[n], one];
    return 0.5 * y * one - two + c[0];
  };
}

/** Return the function that interpolates f on [low, high] by Chebyshev polynomials. */
function chebyshev(f, low, high, degree) {
  const c = new Float64Array(degree + 1);
  for (let i = 0; i <= degree; i += 1) {
    const angle = (Math.PI * (i + 0.5)) / (degree + 1);
    const value = f(0.5 * (low + high) + 0.5 * (high - low) * Math.cos(angle));
    for (let n = 0; n <= degree; n += 1) c[n] += ((n ? 2 : 1) / (degree + 1)) * value * Math.cos(n * angle);
  }
  return series(c, low, high);
}

/** Return the function that series between rising edges make together; 0 outside. */
function joined(edges, parts) {
  return (at) => {
    if (at < edges[0] || at >= edges.at(-1)) return 0;
    return parts[Math.max(0, firstAtLeast(edges, at) - 1)](at);
  };
}

/** Return the function whose Chebyshev coefficients between rising edges are given. */
const pieces = (edges, all) =>
  joined(
    edges,
    all.map((c, i) => series(c, edges[i], edges[i + 1])),
  );

/** Return the function that interpolates f between rising edges, panel by panel. */
const piecewise = (f, edges, degree) =>
  joined(
    edges,
    edges.slice(1).map((edge, i) => chebyshev(f, edges[i], edge, degree)),
  );

/** Return the value of a polynomial. */
function polynomial(c, x) {
  let sum = 0;
  for (let n = c.length - 1; n >= 0; n -= 1) sum = sum * x + c[n];
  return sum;
}

/** Return the density of the standard normal law. */
const normalDensity = (z) => Math.exp(-0.5 * z * z) / Math.sqrt(2 * Math.PI);

/** Return P(Z <= z) for z >= 0: 1/2 + density (z + z^3/3 + z^5/15 + ...), all terms of one sign. */
function normalMass(z) {
  if (z > 9) return 1;
  let term = z;
  let sum = 0;
  for (let n = 1; term > 1e-17 * sum; n += 1) {
    sum += term;
    term *= (z * z) / (2 * n + 1);
  }
  return 0.5 + normalDensity(z) * sum;
}

rub.numbers = { gauss, panels, evenly, lastWhere, ordered, chebyshev, piecewise, pieces };
Object.assign(rub.numbers, { polynomial, normalDensity, normalMass });
