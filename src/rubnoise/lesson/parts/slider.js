'use strict';
/* The slider m x'' + c x' + k x = F over one tick, exact for a force that is a straight line between ticks. */
(() => {
  const rub = (globalThis.rub ??= {});

  /** Return even e^(-at) cosh(st) and odd e^(-at) sinh(st)/s, s^2 = a^2 - k/m, of the free motion; s may be imaginary. */
  function freeMotion(rate, square, time) {
    if (Math.abs(square) * time * time < 1e-10) {
      const decay = Math.exp(-rate * time);
      return [decay * (1 + (square * time * time) / 2), decay * time * (1 + (square * time * time) / 6)];
    }
    if (square < 0) {
      const turn = Math.sqrt(-square);
      const decay = Math.exp(-rate * time);
      return [decay * Math.cos(turn * time), (decay * Math.sin(turn * time)) / turn];
    }
    const root = Math.sqrt(square);
    const slow = Math.exp((root - rate) * time);
    const fast = Math.exp(-(root + rate) * time);
    return [0.5 * (slow + fast), (0.5 * (slow - fast)) / root];
  }

  /**
   * Return the constants of a step. Between ticks h/d = 0.02 apart the area is no straight line: that leaves some 1e-4 of
   * the largest displacement, as the tests hold against the exact motion of the Python package.
   */
  function propagator({ mass, stiffness, damping }, time) {
    const rate = damping / (2 * mass);
    const own = stiffness / mass;
    const [even, odd] = freeMotion(rate, rate * rate - own, time);
    return { xx: even + rate * odd, xv: odd, vx: -own * odd, vv: even - rate * odd, time, damping, stiffness };
  }

  /** Move state = [x, x'] over one tick, during which the force goes from one value to the next in a straight line. */
  function step(p, state, force, next) {
    const slope = (next - force) / p.time;
    const drift = slope / p.stiffness;
    const rest = force / p.stiffness - (p.damping * drift) / p.stiffness;
    const x = state[0] - rest;
    const v = state[1] - drift;
    state[0] = rest + drift * p.time + p.xx * x + p.xv * v;
    state[1] = drift + p.vx * x + p.vv * v;
  }

  rub.slider = { propagator, step };
})();
