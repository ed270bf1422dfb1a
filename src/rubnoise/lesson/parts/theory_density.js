'use strict';
/* How real contact area is distributed where births are at random: not the bell curve, though it tends to it. */
(() => {
  const rub = (globalThis.rub ??= {});
  const { panels, evenly, piecewise } = rub.numbers;
  const BLUR = 1 / 400; // of the largest area: a bar is wider, and the transform ends where it is blurred away
  const PANEL = 4;
  const rising = panels([0, Math.PI / 4, Math.PI / 2], 32);

  /** Return int_0^1 (exp(i y a(u)) - 1) du over the rising half of a life of unit diameter: [real, imaginary]. */
  function halfLife(pulse, y) {
    let [real, imaginary] = [0, 0];
    for (let i = 0; i < rising.nodes.length; i += 1) {
      const phase = y * pulse.area(2 * Math.sin(rising.nodes[i] / 2) ** 2, 1);
      const weight = rising.weights[i] * Math.sin(rising.nodes[i]);
      real -= weight * 2 * Math.sin(phase / 2) ** 2;
      imaginary += weight * Math.sin(phase);
    }
    return [real, imaginary];
  }

  /** Return both parts of the above as functions of y up to a largest, by interpolation. */
  function tabulated(pulse, most) {
    const edges = evenly(0, most + PANEL, Math.ceil(most / PANEL) + 1);
    return [0, 1].map((part) => piecewise((y) => halfLife(pulse, y)[part], edges, 15));
  }

  /** Return log E[exp(i theta A_r)] = 2 lam E[d int_0^1 (exp(i theta d^2 a(u)) - 1) du]: [real, imaginary]. */
  function logarithm({ sizes, birthRate }, parts, theta) {
    const { nodes, weights } = sizes.rule(5);
    return parts.map((part) => {
      let sum = 0;
      for (let i = 0; i < nodes.length; i += 1) sum += weights[i] * nodes[i] * part(theta * nodes[i] ** 2);
      return 2 * birthRate * sum;
    });
  }

  /**
   * Return the density of A_r at areas from 0 to top in um^2, in 1/um^2, for Poisson births: the transform of its
   * characteristic function without the atom exp(-E[N]) at 0, blurred by top / 400. Source: Rice 1944, section 1.4.
   */
  rub.theory.areaDensity = (contact, top, count = 241) => {
    const stride = Math.PI / (1.25 * top);
    const most = Math.ceil(6 / (BLUR * top * stride));
    const parts = tabulated(contact.pulse, most * stride * contact.sizes.high ** 2);
    const atom = Math.exp(-2 * contact.birthRate * contact.sizes.moment(1));
    const density = new Float64Array(count);
    for (let n = 0; n <= most; n += 1) {
      const theta = n * stride;
      const [real, imaginary] = logarithm(contact, parts, theta);
      const window = ((n ? 1 : 0.5) * stride * Math.exp(-0.5 * (theta * BLUR * top) ** 2)) / Math.PI;
      const size = Math.exp(real);
      addWave(density, top, theta, window * (size * Math.cos(imaginary) - atom), window * size * Math.sin(imaginary));
    }
    return density;
  };

  /** Add the real part of (real + i imaginary) exp(-i theta x) at areas x from 0 to top. */
  function addWave(density, top, theta, real, imaginary) {
    for (let i = 0; i < density.length; i += 1) {
      const phase = (theta * top * i) / (density.length - 1);
      density[i] += real * Math.cos(phase) + imaginary * Math.sin(phase);
    }
  }
})();
