/* The knobs: each a slider and a number that say the same, in the units of the page. */
const { make } = rub;
const STEPS = 400;
/* Setting, label, and its choices, or its unit, what that is in the working one, lowest and highest of the slider. */
const SETTINGS = [
  ['meanArea', 'mean area A<sub>rm</sub>', 'µm²', 1, 20, 1000],
  ['meanCount', 'junctions N<sub>jm</sub>', '', 1, 1, 200],
  ['spread', 'spread of diameters', 'µm', 1, 0, 2],
  ['births', 'births', { poisson: 'at random (Poisson)', regular: 'regular' }],
  ['pulse', 'life', { lens: 'lens (two circles)', triangle: 'triangle (Rabinowicz)', parabola: 'parabola (hills)' }],
  ['offset', 'passes', { none: 'on the centre line', uniform: 'off the centre line' }],
  ['heights', 'height scale s<sub>0</sub>', 'µm', 1, 0.1, 10],
  ['speed', 'sliding speed', 'mm/s', 1000, 0.05, 1000],
  ['strength', 'shear strength', 'MPa', 1, 10, 1000],
  ['mass', 'mass', 'g', 1e-3, 0.1, 100],
  ['stiffness', 'stiffness', 'N/m', 1, 10, 10000],
  ['damping', 'damping', 'N s/m', 1, 0.001, 5],
  ['support', 'separation', { gap: 'constant gap', load: 'constant load', free: 'free to hop' }],
  ['coupling', 'coupling', { 'one-way': 'The drive’s speed is constant', 'two-way': 'The slider pushes back' }],
];
const knobs = { inputs: {}, choices: {} };

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

/** Change a setting; show what it is where it cannot be so. */
const change = (key, value, restart = false) => rub.set({ [key]: value }, { restart }) || knobs.show();

/** Return the elements of a number: a slider, the number itself and its unit. */
function ofNumber(key, label, unit, factor, low, high) {
  const slid = ({ target }) => change(key, rounded(key, valueAt(Number(target.value), low, high)) * factor);
  const typed = ({ target }) => change(key, Number(target.value) * factor);
  const slider = make('input', { type: 'range', id: `knob-${key}`, min: 0, max: STEPS, step: 1, oninput: slid });
  const name = `${label.replace(/<[^>]*>/g, '')}, number`;
  const exact = { type: 'number', id: `exact-${key}`, step: 'any', 'aria-label': name };
  const number = make('input', { ...exact, onchange: typed });
  knobs.inputs[key] = { slider, number, unit, factor, low, high };
  return [slider, number, make('span', { class: 'unit', text: unit })];
}

/** Return the element of a choice. */
function ofChoice(key, options) {
  const items = Object.entries(options).map(([value, text]) => make('option', { value, text }));
  const onchange = ({ target }) => change(key, target.value, key !== 'coupling');
  return (knobs.choices[key] = make('select', { id: `knob-${key}`, onchange }, ...items));
}

/** Show the settings as they are. */
knobs.show = () => {
  for (const [key, { slider, number, unit, factor, low, high }] of Object.entries(knobs.inputs)) {
    const value = Number((rub.world[key] / factor).toPrecision(12));
    if (document.activeElement !== slider) slider.value = stepAt(value, low, high);
    slider.setAttribute('aria-valuetext', `${rub.plot.said(value)} ${unit}`);
    number.value = value;
  }
  for (const [key, choice] of Object.entries(knobs.choices)) choice.value = rub.world[key];
  document.getElementById('knob-seed').value = rub.world.seed;
};

/** Show the controls that a lesson needs, by key, and fold the others away, each in its order. */
let unfolded = null;
knobs.fold = (needed) => {
  if (needed === unfolded) return;
  unfolded = needed;
  for (const [key] of SETTINGS) {
    const place = document.getElementById(needed.includes(key) ? 'knobs' : 'other-knobs');
    place.append(document.getElementById(`knob-${key}`).closest('.knob'));
  }
  document.getElementById('more-controls').open = false;
};

/** Make the knobs. */
knobs.begin = (place) => {
  for (const setting of SETTINGS) {
    const [key, label, third] = setting;
    const isNumber = typeof third === 'string';
    const inputs = isNumber ? ofNumber(...setting) : [ofChoice(key, third)];
    const name = make('label', { for: `knob-${key}`, html: label });
    place.append(make('div', { class: isNumber ? 'knob' : 'knob choice' }, name, ...inputs));
  }
  const seed = document.getElementById('knob-seed');
  seed.addEventListener('change', () => change('seed', Math.floor(Number(seed.value)), true));
  document.getElementById('reset').addEventListener('click', () => rub.reset());
  rub.on('settings', knobs.show);
  rub.on('refused', (problem) => {
    document.getElementById('status').textContent = problem;
  });
};

rub.knobs = knobs;
