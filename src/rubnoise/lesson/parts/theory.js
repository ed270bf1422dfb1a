/* What is exact about a world: Campbell's theorem and what follows from it. Regular births: theory_regular.js. */
const { panels, evenly, ordered } = rub.numbers;

/** Return how many panels follow a function of k d over all sizes. */
const panelsFor = (sizes, k) => Math.max(5, Math.ceil(((sizes.high - sizes.low) * k) / 8));

/** Return E[f(d)] over sizes, f smooth but for a swing in k d. */
function average(sizes, k, f) {
  const { nodes, weights } = sizes.rule(panelsFor(sizes, k));
  let sum = 0;
  for (let i = 0; i < nodes.length; i += 1) sum += weights[i] * f(nodes[i]);
  return sum;
}

/** Return lam E[d^6 |a^(k d)|^2], the two-sided spectral density of Poisson births in um^4 per rad/um. */
function shotDensity(contact, k) {
  const { energy } = contact.pulse;
  return contact.birthRate * average(contact.sizes, k, (d) => d ** 6 * energy(k * d));
}

/** Return the same with the swing of its tail averaged out, for panels of k wider than a swing. */
function smoothDensity(contact, k) {
  const { meanSquare } = contact.pulse;
  return contact.birthRate * average(contact.sizes, 0, (d) => d ** 6 * meanSquare(k * d));
}

/** Return lam E[int A(s) A(s + lag) ds] in um^4: the autocovariance of Poisson births. */
function shotCovariance(contact, lag) {
  const { sizes, pulse, birthRate } = contact;
  const tau = Math.abs(lag);
  if (sizes.high <= 0.5 * tau) return 0;
  const rule = sizes.cutRule([0.5 * tau, tau]);
  let sum = 0;
  rule.nodes.forEach((d, i) => {
    if (2 * d > tau) sum += rule.weights[i] * d ** 5 * pulse.overlap(tau / d);
  });
  return birthRate * sum;
}

/** Return E[N] by Little's law: births in a um times their mean life. */
const countMean = ({ pulse, birthRate, sizes }) => birthRate * pulse.meanLife * sizes.moment(1);

/** Return variance and third cumulant of A_r for Poisson births, lam c_n m_(2n+1), and Var[N]. */
function shotCumulants({ pulse, birthRate, sizes }) {
  const cumulant = (n) => birthRate * pulse.lifeIntegrals[n - 1] * sizes.moment(2 * n + 1);
  return { variance: cumulant(2), third: cumulant(3), countVariance: countMean({ pulse, birthRate, sizes }) };
}

/** Return the wavenumber in rad/um up to which the swing of the spectrum's tail is followed. */
function followedUpTo({ sizes }) {
  if (sizes.std === 0) return FOLLOWED / sizes.high;
  /* Sizes that differ by some waves average over the swing themselves; the smallest of them hardly count. */
  return Math.min(FOLLOWED / sizes.high, Math.max(7 / sizes.std, 32 / Math.max(sizes.low, 0.2 * sizes.mean)));
}

/** Return the edges of panels of k that follow spectrum and resonances, in order. */
function responseEdges(contact, slider, world) {
  if (world.support === 'load') {
    const { resonance, damping, mass } = rub.load.of(world);
    const load = { resonance: resonance / world.speed, halfWidth: damping / (2 * mass * world.speed) };
    const edges = [slider, load].flatMap((each) => responseEdges(contact, each, { support: 'gap' }));
    return ordered(edges);
  }
  const reach = contact.sizes.high;
  const [step, followed] = [PHASE / reach, followedUpTo(contact)];
  const { resonance, halfWidth } = slider;
  const edges = [0, ...octaves(1e-3 * Math.min(1 / reach, resonance), step), resonance];
  edges.push(...evenly(step, followed, Math.ceil((followed - step) / step)));
  edges.push(...octaves(followed, 1e4 * Math.max(followed, resonance)));
  if (halfWidth < resonance) {
    for (const gap of octaves(0.5 * halfWidth, resonance)) edges.push(resonance + gap, Math.max(0, resonance - gap));
  }
  if (contact.sizes.std === 0 && resonance > followed && halfWidth * reach < 30) {
    for (let i = -200; i <= 200; i += 1) edges.push(Math.max(0, resonance + i * step));
  }
  return ordered(edges);
}

const FOLLOWED = 600;
const PHASE = 8;

function octaves(low, high) {
  const found = [];
  for (let value = low; value < 2 * high; value *= 2) found.push(Math.min(value, high));
  return found;
}

/** Return the slider as the spectrum sees it: resonance and its half width in rad/um, |H|^2 in (um/uN)^2. */
function sliderOf({ mass, stiffness, damping, speed }) {
  const resonance = Math.sqrt(stiffness / mass) / speed;
  const halfWidth = damping / (2 * mass * speed);
  const gain = (k) => 1 / ((stiffness - mass * (k * speed) ** 2) ** 2 + (damping * k * speed) ** 2);
  return { resonance, halfWidth, gain };
}

/**
 * Return the stationary standard deviations of displacement (um) and velocity (um/s) of the one-way slider, of the
 * force (uN) and, where it rises under its load, of the separation (um): Var x = (psi^2 / pi) int_0^inf S(k) g(k)
 * |H(k V)|^2 dk, with (k V)^2 for x', and without H for the force; g is what the load leaves of the force.
 */
function sliderSpread(world, contact, density, lines) {
  const slider = sliderOf(world);
  const { load, rise } = rub.load.gains(world);
  const sums = [0, 0, 0, 0];
  const add = (k, all) => {
    const power = all * load(k);
    sums[0] += power * slider.gain(k);
    sums[1] += power * slider.gain(k) * (k * world.speed) ** 2;
    sums[2] += power;
    sums[3] += all * rise(k);
  };
  const edges = responseEdges(contact, slider, world);
  const wide = (1.01 * PHASE) / contact.sizes.high;
  const followed = contact.sizes.std === 0 ? Infinity : 1.01 * followedUpTo(contact);
  for (let i = 0; i + 1 < edges.length; i += 1) {
    const follows = edges[i + 1] - edges[i] <= wide && edges[i] < followed;
    const { nodes, weights } = panels([edges[i], edges[i + 1]], 12);
    nodes.forEach((k, j) => add(k, (weights[j] / Math.PI) * density(k, follows)));
  }
  lines.forEach(({ wavenumber, power }) => add(wavenumber, 2 * power));
  const [displacementStd, velocityStd, forceStd] = sums.map((sum) => world.strength * Math.sqrt(sum));
  return { displacementStd, velocityStd, forceStd, separationStd: Math.sqrt(sums[3]) / world.meanArea };
}

/** Return density, covariance, cumulants and lines of the births that a world has. */
function lawOf(world, contact) {
  if (world.births === 'regular') return rub.theory.regular(contact);
  return {
    ...shotCumulants(contact),
    density: (k, follows = true) => (follows ? shotDensity : smoothDensity)(contact, k),
    covariance: (lag) => shotCovariance(contact, lag),
    lines: () => [],
  };
}

/** Return what is exact about a world; what takes long is computed when it is first asked for. */
function exact(world) {
  const contact = rub.model.contact(world);
  const { sizes, pulse, birthRate } = contact;
  const law = lawOf(world, contact);
  const areaMean = birthRate * pulse.lifeIntegrals[0] * sizes.moment(3);
  const areaStd = Math.sqrt(law.variance) > 1e-12 * areaMean ? Math.sqrt(law.variance) : 0;
  let spread = null;
  const slider = () => (spread ??= sliderSpread(world, contact, law.density, law.lines()));
  return {
    contact,
    diameter: contact.diameter,
    diameterMean: sizes.moment(1),
    lengthBiasedMean: sizes.moment(2) / sizes.moment(1),
    lifeMean: pulse.meanLife * sizes.moment(1),
    lifeAreaMean: pulse.lifeMean * contact.diameter ** 2,
    spacing: contact.spacing,
    birthRate,
    countMean: countMean(contact),
    countStd: Math.sqrt(Math.max(0, law.countVariance)),
    areaMean,
    areaStd,
    skewness: areaStd > 0 ? law.third / areaStd ** 3 : NaN,
    forceMean: world.strength * areaMean,
    get forceStd() {
      return world.support === 'load' ? slider().forceStd : world.strength * areaStd;
    },
    get separationStd() {
      return slider().separationStd;
    },
    displacementMean: (world.strength * areaMean) / world.stiffness,
    naturalFrequency: Math.sqrt(world.stiffness / world.mass) / (2 * Math.PI),
    dampingRatio: world.damping / (2 * Math.sqrt(world.stiffness * world.mass)),
    get displacementStd() {
      return slider().displacementStd;
    },
    get velocityStd() {
      return slider().velocityStd;
    },
    get oneWay() {
      return slider().velocityStd / world.speed;
    },
    /** The level about which the spectrum of births at random falls off, and its power of the wavenumber. */
    tail: (k) => (birthRate * pulse.tail[0] * sizes.moment(6 - pulse.tail[1])) / k ** pulse.tail[1],
    tailPower: pulse.tail[1],
    lines: law.lines,
    spectrum: (k) => law.density(Math.abs(k)),
    autocovariance: law.covariance,
  };
}

Object.assign((rub.theory = {}), { exact, average, panelsFor, countMean, sliderOf });
Object.assign(rub.theory, { shotDensity, smoothDensity, shotCovariance });
