/* What is exact where births are regular: a mixture over their phase, which is uniform over one spacing. */
const { panels, ordered, piecewise } = rub.numbers;

/** Return ages between which the mean life is smooth: octaves of distance from mid-life and from death. */
function turnsOf({ sizes, diameter }) {
  const longest = 2 * sizes.high;
  if (sizes.std === 0) return [0, diameter, longest];
  const edges = [0, longest];
  for (const [turn, blur] of [
    [diameter, sizes.std],
    [2 * diameter, 2 * sizes.std],
  ]) {
    for (let z = -8; z <= 8; z += 2) edges.push(turn + z * blur);
    for (let gap = 16 * blur; gap < longest; gap *= 2) edges.push(turn - gap, turn + gap);
  }
  for (let age = diameter / 2; age > 1e-3 * diameter; age /= 2) edges.push(age);
  return ordered(edges.filter((edge) => edge >= 0 && edge <= longest));
}

/** Return E[A], E[A^2], E[A^3] and P(alive) at an age, over sizes. */
function momentsAt({ sizes, pulse }, age) {
  const found = [0, 0, 0, 0];
  const { nodes, weights } = sizes.cutRule([0.5 * age, age]);
  for (let i = 0; i < nodes.length; i += 1) {
    const area = pulse.area(age, nodes[i]);
    const once = weights[i] * area;
    found[0] += once;
    found[1] += once * area;
    found[2] += once * area * area;
    if (2 * nodes[i] > age) found[3] += weights[i];
  }
  return found;
}

/**
 * Return the first three cumulants of A at an age and the chance to be alive, as functions of the age: by themselves
 * for one size, else interpolated in the root of the age, in which the birth is smooth.
 */
function lifeOf(contact, turns) {
  const at = (age) => {
    const [m1, m2, m3, alive] = momentsAt(contact, age);
    return [m1, m2 - m1 * m1, m3 - 3 * m1 * m2 + 2 * m1 ** 3, alive];
  };
  if (contact.sizes.std === 0) return [0, 1, 2, 3].map((i) => (age) => at(age)[i]);
  const known = new Map();
  const once = (root) => known.get(root) ?? known.set(root, at(root * root)).get(root);
  return [0, 1, 2, 3].map((i) => {
    const table = piecewise((root) => once(root)[i], turns.map(Math.sqrt), 15);
    return (age) => table(Math.sqrt(age));
  });
}

/** Return the edges of panels of the phase: where a life is at one of its turns that are closer than a spacing. */
function phaseEdges({ spacing }, turns) {
  const near = (i) =>
    turns[i] - (turns[i - 1] ?? -Infinity) < spacing || (turns[i + 1] ?? Infinity) - turns[i] < spacing;
  const one = turns.length === 3;
  const within = turns.filter((turn, i) => one || near(i)).map((turn) => turn % spacing);
  return ordered([0, ...within, spacing]);
}

/** Return cumulants of area given a phase, mean and variance of the count. */
function cumulantsAt({ spacing, sizes }, life, phase) {
  const found = [0, 0, 0, 0, 0];
  for (let age = phase; age < 2 * sizes.high; age += spacing) {
    for (let i = 0; i < 3; i += 1) found[i] += life[i](age);
    const alive = life[3](age);
    found[3] += alive;
    found[4] += alive * (1 - alive);
  }
  return found;
}

/** Return variance, third cumulant and Var[N], by the law of total cumulance over the phase. */
function cumulants(contact, life, turns) {
  const { nodes, weights } = panels(phaseEdges(contact, turns), contact.sizes.std === 0 ? 20 : 8, true);
  const given = Array.from(nodes, (phase) => cumulantsAt(contact, life, phase));
  const mean = (f) => given.reduce((sum, k, i) => sum + (weights[i] / contact.spacing) * f(k), 0);
  const area = mean((k) => k[0]);
  const count = mean((k) => k[3]);
  return {
    variance: mean((k) => k[1] + (k[0] - area) ** 2),
    third: mean((k) => k[2] + 3 * (k[0] - area) * k[1] + (k[0] - area) ** 3),
    countVariance: mean((k) => k[4] + (k[3] - count) ** 2),
  };
}

/** Return |E[A^]|^2 and E[|A^ - E[A^]|^2] of the transform d^3 a^(k d) exp(-i k d) about the birth. */
function meanTransform({ sizes, pulse }, k) {
  const { nodes, weights } = sizes.rule(rub.theory.panelsFor(sizes, 2 * k));
  let [x, y, square] = [0, 0, 0];
  const real = new Float64Array(nodes.length);
  const imaginary = new Float64Array(nodes.length);
  for (let i = 0; i < nodes.length; i += 1) {
    const size = nodes[i] ** 3 * pulse.transform(k * nodes[i]);
    real[i] = size * Math.cos(k * nodes[i]);
    imaginary[i] = size * Math.sin(k * nodes[i]);
    x += weights[i] * real[i];
    y += weights[i] * imaginary[i];
  }
  for (let i = 0; i < nodes.length; i += 1) square += weights[i] * ((real[i] - x) ** 2 + (imaginary[i] - y) ** 2);
  return { square: x * x + y * y, spread: square };
}

/** Return the spread where mid-life and death are blurred over many waves: of the mean the birth alone is left. */
function blurredSpread(contact, k) {
  const { sizes, pulse, birthRate } = contact;
  const part = (i) => rub.theory.average(sizes, 0, (d) => d ** 3 * pulse.birth(k * d)[i]);
  return rub.theory.smoothDensity(contact, k) / birthRate - part(0) ** 2 - part(1) ** 2;
}

/**
 * Return the lines at k_n = 2 pi n / spacing with the power lam^2 |E[A^(k_n)]|^2 of each: as many as it takes until
 * what is left, which falls at least as n^-3 for lives of one size and faster for others, is 1e-10 of the variance.
 */
function linesOf(contact, variance) {
  const found = [];
  const most = contact.sizes.std === 0 ? 8192 : 1000;
  for (let n = 1, weak = 0; n <= most && weak < 8; n += 1) {
    const wavenumber = 2 * Math.PI * n * contact.birthRate;
    const power = contact.birthRate ** 2 * meanTransform(contact, wavenumber).square;
    found.push({ wavenumber, power });
    weak = contact.sizes.std > 0 && power * n < 1e-10 * variance ? weak + 1 : 0;
  }
  return found;
}

/** Return lam int E[A(s)] E[A(s + lag)] ds in um^4: the part of single lives that the phase fixes. */
function sharedCovariance(contact, mean, turns, lag) {
  const last = 2 * contact.sizes.high - lag;
  if (last <= 0) return 0;
  const edges = ordered(
    [0, last, ...turns, ...turns.map((turn) => turn - lag)].filter((edge) => edge >= 0 && edge <= last),
  );
  const { nodes, weights } = panels(edges, 10);
  let sum = 0;
  for (let i = 0; i < nodes.length; i += 1) sum += weights[i] * mean(nodes[i]) * mean(nodes[i] + lag);
  return contact.birthRate * sum;
}

function covarianceOf(contact, mean, turns, lines) {
  return (lag) => {
    const tau = Math.abs(lag);
    let waves = 0;
    for (const { wavenumber, power } of lines()) waves += 2 * power * Math.cos(wavenumber * tau);
    if (contact.sizes.std === 0) return waves;
    return rub.theory.shotCovariance(contact, tau) - sharedCovariance(contact, mean, turns, tau) + waves;
  };
}

/** Return density, covariance, cumulants and lines of regular births. */
rub.theory.regular = (contact) => {
  let known = null;
  const turns = turnsOf(contact);
  const life = lifeOf(contact, turns);
  const found = cumulants(contact, life, turns);
  const lines = () => (known ??= linesOf(contact, found.variance));
  const one = contact.sizes.std === 0;
  const density = (k, follows = true) => {
    if (one) return 0;
    return contact.birthRate * (follows ? meanTransform(contact, k).spread : blurredSpread(contact, k));
  };
  return { ...found, density, covariance: covarianceOf(contact, life[0], turns, lines), lines };
};
