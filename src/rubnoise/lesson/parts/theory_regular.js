'use strict';
/* What is exact where births are regular: a mixture over their phase, which is uniform over one spacing. */
(() => {
  const rub = (globalThis.rub ??= {});
  const { panels, evenly, ordered } = rub.numbers;

  /** Return the edges of panels of the phase: where a life begins, is at its middle, or ends. */
  function phaseEdges({ sizes, spacing, diameter }) {
    const turns = [];
    const { std } = sizes;
    const steps = std === 0 ? [0] : evenly(-8, 8, 8);
    if (2 * std < spacing) steps.forEach((z) => turns.push(diameter + z * std, 2 * (diameter + z * std)));
    const within = turns.filter((turn) => turn > 0).map((turn) => turn % spacing);
    return ordered([...evenly(0, spacing, std === 0 ? 1 : 4), ...within]);
  }

  /** Return E[A], E[A^2], E[A^3] and P(alive) at an age, over sizes, into an array of four. */
  function momentsAt({ sizes, pulse }, age, into) {
    into.fill(0);
    const { nodes, weights } = sizes.cutRule([0.5 * age, age]);
    for (let i = 0; i < nodes.length; i += 1) {
      const area = pulse.area(age, nodes[i]);
      const once = weights[i] * area;
      into[0] += once;
      into[1] += once * area;
      into[2] += once * area * area;
      if (2 * nodes[i] > age) into[3] += weights[i];
    }
  }

  /** Return cumulants of area given a phase, and mean and variance of the count. */
  function cumulantsAt(contact, phase) {
    const found = [0, 0, 0, 0, 0];
    const m = new Float64Array(4);
    for (let age = phase; age < 2 * contact.sizes.high; age += contact.spacing) {
      momentsAt(contact, age, m);
      found[0] += m[0];
      found[1] += m[1] - m[0] * m[0];
      found[2] += m[2] - 3 * m[0] * m[1] + 2 * m[0] ** 3;
      found[3] += m[3];
      found[4] += m[3] * (1 - m[3]);
    }
    return found;
  }

  /** Return variance, third cumulant and Var[N], by the law of total cumulance over the phase. */
  function cumulants(contact) {
    const { nodes, weights } = panels(phaseEdges(contact), 12, true);
    const given = Array.from(nodes, (phase) => cumulantsAt(contact, phase));
    const mean = (f) => given.reduce((sum, k, i) => sum + (weights[i] / contact.spacing) * f(k), 0);
    const area = mean((k) => k[0]);
    const count = mean((k) => k[3]);
    return {
      variance: mean((k) => k[1] + (k[0] - area) ** 2),
      third: mean((k) => k[2] + 3 * (k[0] - area) * k[1] + (k[0] - area) ** 3),
      countVariance: mean((k) => k[4] + (k[3] - count) ** 2),
    };
  }

  /** Return the mean transform E[d^3 a^(k d) exp(-i k d)], about the birth, and the spread about it. */
  function meanTransform({ sizes, pulse }, k) {
    const { nodes, weights } = sizes.rule(rub.theory.panelsFor(sizes, 2 * k));
    const real = Array.from(nodes, (d) => d ** 3 * pulse.transform(k * d) * Math.cos(k * d));
    const imaginary = Array.from(nodes, (d) => d ** 3 * pulse.transform(k * d) * Math.sin(k * d));
    const mean = (values) => values.reduce((sum, value, i) => sum + weights[i] * value, 0);
    const [x, y] = [mean(real), mean(imaginary)];
    return { square: x * x + y * y, spread: mean(real.map((re, i) => (re - x) ** 2 + (imaginary[i] - y) ** 2)) };
  }

  /**
   * Return the lines at k_n = 2 pi n / spacing with the power lam^2 |E[A^(k_n)]|^2 of each: as many as it takes until what
   * is left, which falls at least as n^-3 for lives of one size and faster for others, is 1e-10 of the variance.
   */
  function linesOf(contact, variance) {
    const found = [];
    const most = contact.sizes.std === 0 ? 8192 : 400;
    for (let n = 1; n <= most; n += 1) {
      const wavenumber = 2 * Math.PI * n * contact.birthRate;
      const power = contact.birthRate ** 2 * meanTransform(contact, wavenumber).square;
      found.push({ wavenumber, power });
      if (contact.sizes.std > 0 && n > 2 && power * n < 1e-10 * variance) break;
    }
    return found;
  }

  /** Return lam int E[A(s)] E[A(s + lag)] ds in um^4: what the phase tells of single lives. */
  function sharedCovariance(contact, mean, lag) {
    const { nodes, weights } = mean.ages;
    const longest = 2 * contact.sizes.high;
    return contact.birthRate * nodes.reduce((sum, age, i) => {
      return age + lag < longest ? sum + weights[i] * mean.at(age) * mean.at(age + lag) : sum;
    }, 0);
  }

  /** Return the mean life, E[A] at an age in um, and a rule over ages. */
  function meanLife(contact) {
    const m = new Float64Array(4);
    const at = (age) => {
      momentsAt(contact, age, m);
      return m[0];
    };
    return { at, ages: panels(evenly(0, 2 * contact.sizes.high, 24), 12) };
  }

  function covarianceOf(contact, lines) {
    let mean = null;
    return (lag) => {
      const tau = Math.abs(lag);
      const waves = lines().reduce((sum, line) => sum + 2 * line.power * Math.cos(line.wavenumber * tau), 0);
      if (contact.sizes.std === 0) return waves;
      mean ??= meanLife(contact);
      return rub.theory.shotCovariance(contact, tau) - sharedCovariance(contact, mean, tau) + waves;
    };
  }

  /** Return density, covariance, cumulants and lines of regular births. */
  rub.theory.regular = (contact) => {
    let known = null;
    const found = cumulants(contact);
    const lines = () => (known ??= linesOf(contact, found.variance));
    const one = contact.sizes.std === 0;
    /* Where sizes are spread over many waves their mean transform is nothing beside its square. */
    const density = (k, follows = true) => {
      if (one) return 0;
      if (!follows && k * contact.sizes.std > 10) return rub.theory.smoothDensity(contact, k);
      return contact.birthRate * meanTransform(contact, k).spread;
    };
    return { ...found, density, covariance: covarianceOf(contact, lines), lines };
  };
})();
