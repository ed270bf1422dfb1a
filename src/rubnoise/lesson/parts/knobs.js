'use strict';
/* The knobs: each a slider and a number that say the same, in the units of the page. */
(() => {
  const rub = (globalThis.rub ??= {});
  const STEPS = 400;
  /* Setting, label, unit, factor from the unit to the working one, lowest and highest of the slider, in the unit. */
  const KNOBS = [
    ['meanArea', 'mean area A<sub>rm</sub>', 'µm²', 1, 20, 1000],
    ['meanCount', 'junctions N<sub>jm</sub>', '', 1, 1, 200],
    ['spread', 'spread of diameters', 'µm', 1, 0, 2],
    ['heights', 'height scale s<sub>0</sub>', 'µm', 1, 0.1, 10],
    ['speed', 'sliding speed', 'mm/s', 1000, 0.05, 1000],
    ['strength', 'shear strength', 'MPa', 1, 10, 1000],
    ['mass', 'mass', 'g', 1e-3, 0.1, 100],
    ['stiffness', 'stiffness', 'N/m', 1, 10, 10000],
    ['damping', 'damping', 'N s/m', 1, 0.001, 5],
  ];
  const CHOICES = [
    ['births', 'births', { poisson: 'at random (Poisson)', regular: 'regular' }],
    ['pulse', 'life', { lens: 'lens (two circles)', triangle: 'triangle (Rabinowicz)', parabola: 'parabola (hills)' }],
    ['offset', 'passes', { none: 'on the centre line', uniform: 'off the centre line' }],
    ['support', 'separation', { gap: 'constant gap', load: 'constant load', free: 'free to hop' }],
    ['coupling', 'coupling', { 'one-way': 'The drive’s speed is constant', 'two-way': 'The slider pushes back' }],
  ];
  const OF_CONTACT = 3; // choices that stand among the knobs of the contact
  const knobs = { inputs: {} };

  /* Sliders run over the logarithm, but for one that begins at 0. */
  const valueAt = (step, low, high) => (low > 0 ? low * (high / low) ** (step / STEPS) : (high * step) / STEPS);

  function stepAt(value, low, high) {
    const part = low > 0 ? Math.log(Math.max(value, low) / low) / Math.log(high / low) : value / high;
    return Math.round(Math.min(1, Math.max(0, part)) * STEPS);
  }

  /** Round to three digits, and junctions to whole ones below ten. */
  function rounded(key, value) {
    const digits = Number(value.toPrecision(key === 'meanCount' ? 2 : 3));
    return key === 'meanCount' ? Math.max(1, Math.round(digits)) : digits;
  }

  function markup([key, label, unit]) {
    return `<div class="knob"><label for="knob-${key}">${label}</label>
      <input type="range" id="knob-${key}" min="0" max="${STEPS}" step="1">
      <input type="number" id="exact-${key}" step="any" aria-label="${label.replace(/<[^>]*>/g, '')}, number">
      <span class="unit">${unit}</span></div>`;
  }

  function choiceMarkup([key, label, options]) {
    const items = Object.entries(options).map(([value, text]) => `<option value="${value}">${text}</option>`);
    const choice = `<select id="knob-${key}">${items.join('')}</select>`;
    return `<div class="knob choice"><label for="knob-${key}">${label}</label>${choice}</div>`;
  }

  function connect([key, , unit, factor, low, high]) {
    const slider = document.getElementById(`knob-${key}`);
    const number = document.getElementById(`exact-${key}`);
    knobs.inputs[key] = { slider, number, unit, factor, low, high };
    slider.addEventListener('input', () => {
      const value = rounded(key, valueAt(Number(slider.value), low, high));
      rub.set({ [key]: value * factor }, { restart: false });
    });
    number.addEventListener('change', () => {
      rub.set({ [key]: Number(number.value) * factor }, { restart: false }) || knobs.show();
    });
  }

  /** Show the settings as they are. */
  knobs.show = () => {
    for (const [key, { slider, number, unit, factor, low, high }] of Object.entries(knobs.inputs)) {
      const value = Number((rub.world[key] / factor).toPrecision(12));
      if (document.activeElement !== slider) slider.value = stepAt(value, low, high);
      slider.setAttribute('aria-valuetext', `${rub.plot.said(value)} ${unit}`);
      number.value = value;
    }
    for (const [key] of CHOICES) document.getElementById(`knob-${key}`).value = rub.world[key];
    document.getElementById('knob-seed').value = rub.world.seed;
  };

  /** Show the controls that a lesson needs, by key, and fold the others away, each in its order. */
  let unfolded = null;
  knobs.fold = (needed) => {
    if (needed === unfolded) return;
    unfolded = needed;
    for (const [key] of [...KNOBS, ...CHOICES]) {
      const place = document.getElementById(needed.includes(key) ? 'knobs' : 'other-knobs');
      place.append(document.getElementById(`knob-${key}`).closest('.knob'));
    }
    document.getElementById('more-controls').open = false;
  };

  /** Make the knobs. */
  knobs.begin = (place) => {
    place.innerHTML =
      KNOBS.slice(0, 3).map(markup).join('') +
      CHOICES.slice(0, OF_CONTACT).map(choiceMarkup).join('') +
      KNOBS.slice(3).map(markup).join('') +
      CHOICES.slice(OF_CONTACT).map(choiceMarkup).join('');
    KNOBS.forEach(connect);
    for (const [key] of CHOICES) {
      const choice = document.getElementById(`knob-${key}`);
      choice.addEventListener('change', () => {
        rub.set({ [key]: choice.value }, { restart: key !== 'coupling' }) || knobs.show();
      });
    }
    const seed = document.getElementById('knob-seed');
    seed.addEventListener('change', () => rub.set({ seed: Math.floor(Number(seed.value)) }) || knobs.show());
    document.getElementById('reset').addEventListener('click', () => rub.reset());
    rub.on('settings', knobs.show);
    rub.on('refused', (problem) => {
      document.getElementById('status').textContent = problem;
    });
  };

  rub.knobs = knobs;
})();
