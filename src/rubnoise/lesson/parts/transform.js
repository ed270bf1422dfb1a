'use strict';
/* The Fourier transform of a life of unit diameter about its middle. */
(() => {
  const rub = (globalThis.rub ??= {});
  const { chebyshev, panels } = rub.numbers;
  const FAR = 32;
  const fine = panels([0, Math.PI / 4, Math.PI / 2], 40);

  /** Return pi H_1(z) / z^2 = (2/z) int_0^(pi/2) cos^2(t) sin(z sin t) dt by quadrature; 2/3 at 0. */
  function byQuadrature(z) {
    const sinc = (x) => (x === 0 ? 1 : Math.sin(x) / x);
    const term = (t) => 2 * Math.cos(t) ** 2 * Math.sin(t) * sinc(z * Math.sin(t));
    return fine.nodes.reduce((sum, t, i) => sum + fine.weights[i] * term(t), 0);
  }

  const near = [
    [0, 10],
    [10, 20],
    [20, FAR],
  ].map(([low, high]) => chebyshev(byQuadrature, low, high, 28));

  /** Return H_1(z) - Y_1(z) = (2/pi) (1 + 1/z^2 - 3/z^4 + 45/z^6 - ...), z >= 32 (DLMF 11.6.1). */
  function struveTail(z) {
    let term = 1;
    let sum = 1;
    for (let n = 1; n <= 12; n += 1) {
      term *= (-(2 * n - 1) * (2 * n - 3)) / (z * z);
      sum += term;
    }
    return (2 / Math.PI) * sum;
  }

  /** Return P and Q of Hankel's expansion for order 1, z >= 16 (DLMF 10.17.3). */
  function hankel(z) {
    let term = 1;
    let even = 1;
    let odd = 0;
    for (let n = 1; n <= 14; n += 1) {
      term *= (4 - (2 * n - 1) ** 2) / (n * 8 * z);
      if (n % 2) odd += n % 4 === 1 ? term : -term;
      else even += n % 4 === 2 ? -term : term;
    }
    return [even, odd];
  }

  function bessel(z) {
    const [even, odd] = hankel(z);
    const phase = z - 0.75 * Math.PI;
    return Math.sqrt(2 / (Math.PI * z)) * (even * Math.sin(phase) + odd * Math.cos(phase));
  }

  /** Return a^(z) = pi H_1(z) / z^2 of the lens, z = k d >= 0. */
  function lens(z) {
    if (z < FAR) return near[z < 10 ? 0 : z < 20 ? 1 : 2](z);
    return (Math.PI * (bessel(z) + struveTail(z))) / (z * z);
  }

  /** Return a^(z)^2 averaged over its swing, z >= 32: (pi / z^2)^2 ((H_1 - Y_1)^2 + (J_1^2 + Y_1^2) / 2). */
  function lensMeanSquare(z) {
    if (z < FAR) return lens(z) ** 2;
    const [even, odd] = hankel(z);
    const swing = (even * even + odd * odd) / (Math.PI * z);
    return (Math.PI / (z * z)) ** 2 * (struveTail(z) ** 2 + swing);
  }

  /** Return what the birth alone brings to a^(z) about the birth, z >= 32, but for a turn: [real, imaginary]. */
  function lensBirth(z) {
    if (z < FAR) return [0, 0];
    const size = (Math.PI / (z * z)) * Math.sqrt(1 / (2 * Math.PI * z));
    return hankel(z).map((part) => part * size);
  }

  /** Return the same of the triangle: (pi/4) / z^2. */
  const triangleBirth = (z) => (z < FAR ? [0, 0] : [Math.PI / (4 * z * z), 0]);

  /** Return a^(z) = (pi/4) (sin(z/2) / (z/2))^2 of the triangle. */
  function triangle(z) {
    const sinc = z < 1e-8 ? 1 : Math.sin(z / 2) / (z / 2);
    return (Math.PI / 4) * sinc * sinc;
  }

  /** Return a^(z)^2 of the triangle, its sin^4 averaged to 3/8 from z = 32 on. */
  function triangleMeanSquare(z) {
    return z < FAR ? triangle(z) ** 2 : ((Math.PI / 4) ** 2 * 0.375 * 16) / z ** 4;
  }

  /** Return a^(z) = pi (sin z - z cos z) / z^3 of the parabola. */
  function parabola(z) {
    if (z > 0.1) return (Math.PI * (Math.sin(z) - z * Math.cos(z))) / z ** 3;
    return Math.PI * (1 / 3 - (z * z) / 30 + z ** 4 / 840 - z ** 6 / 45360);
  }

  /** Return a^(z)^2 of the parabola, averaged over its swing from z = 32 on. */
  function parabolaMeanSquare(z) {
    return z < FAR ? parabola(z) ** 2 : (0.5 * Math.PI ** 2 * (1 + 1 / (z * z))) / z ** 4;
  }

  /** Return what the birth alone brings of the parabola, z >= 32. */
  const parabolaBirth = (z) => (z < FAR ? [0, 0] : [Math.PI / (2 * z * z), -Math.PI / (2 * z ** 3)]);

  rub.model.hankel = hankel;
  Object.assign(rub.model.pulses.lens, {
    transform: lens,
    energy: (z) => lens(z) ** 2,
    meanSquare: lensMeanSquare,
    birth: lensBirth,
  });
  Object.assign(rub.model.pulses.triangle, {
    transform: triangle,
    energy: (z) => triangle(z) ** 2,
    meanSquare: triangleMeanSquare,
    birth: triangleBirth,
  });
  Object.assign(rub.model.pulses.parabola, {
    transform: parabola,
    energy: (z) => parabola(z) ** 2,
    meanSquare: parabolaMeanSquare,
    birth: parabolaBirth,
  });
})();
