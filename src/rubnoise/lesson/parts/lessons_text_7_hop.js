/* Lesson 11: a slider that hops. */
const { lessons, flight } = rub;
const { contact } = lessons;
const { say, um } = lessons.words;
const milli = (speed) => `${say(speed / 1000)} mm/s`;
const [LOW, HIGH] = [0.5, 2]; // um
const SPEED = 80e3; // um/s
const LIGHT = contact({ pulse: 'parabola', sizes: 'rayleigh', meanCount: 0.5, support: 'free', heights: LOW });
const run = (label, heights, speed) => ({ label, set: { ...LIGHT, ...lessons.SLIDER, heights, speed }, show: 'hop' });
const RUNS = [
  run('Low, 80 mm/s', LOW, SPEED),
  run('High, 20 mm/s', HIGH, SPEED / 4),
  run('High, 40 mm/s', HIGH, SPEED / 2),
  run('High, 80 mm/s', HIGH, SPEED),
];
const ANSWERS = ['quarter', 'half', 'same']; // of the runs over high summits
/* A slider that was seen to leave at some speed, and summits nine times as high. */
const LEAVES = 60e3;
const HIGHER = 9;

/** Return the answer whose run was apart for a share of time nearest to that over low summits. */
function says(kept) {
  const shares = RUNS.map((_, i) => kept[i]?.[0]);
  if (!shares.every(Number.isFinite)) return undefined;
  const away = shares.slice(1).map((share) => Math.abs(share - shares[0]));
  return ANSWERS[away.indexOf(Math.min(...away))];
}

lessons.add({
  id: 'hop',
  controls: ['support', 'speed', 'heights', 'meanCount'],
  title: 'Let it hop',
  question: `A light slider touches half a summit on average. It follows the summits while it is slow. At 80 mm/s it
    hops: some of the time it touches nothing. Now all summits are four times as high. At which speed does it hop for
    the same share of the time?`,
  prediction: {
    options: [
      { id: 'quarter', text: `20 mm/s: four times as high, four times as easy` },
      { id: 'half', text: `40 mm/s: half the speed`, right: true },
      { id: 'same', text: `80 mm/s: it is the speed alone that counts` },
      { id: 'twice', text: `160 mm/s: high summits hold it better` },
    ],
  },
  evidence: {
    run: 2,
    row: 0,
    says,
    asks: `At which speed was the slider over high summits apart for the same share of the time as over low ones?`,
  },
  needs: { births: 'poisson', pulse: 'parabola' },
  experiment: {
    pace: 1, // lives a second
    lives: 120,
    text: `The slider of 5 g under 0.2 N, from the side. Heights vary by ${um(LOW)} (low) or ${um(HIGH)} (high); the
      summits lie at the same places. An impact takes away some of its energy.`,
    runs: RUNS,
    watch: [
      `Where does the foot leave a hill: before its top, on it, or behind it?`,
      `The shaded stretches of the trace: how long is the slider apart?`,
      `Turn the speed down until it stays on the surface.`,
    ],
    table: [
      { label: 'share of time apart', seen: (s) => s.apartShare, exact: () => NaN },
      { label: 'mean of the load over the weight', seen: (s) => s.loadMean, exact: () => 1 },
      {
        label: 'speed over <var>c</var>ω<sub>c</sub>',
        seen: (s) => s.relativeSpeed,
        exact: (f, world) => flight.scalesOf(world).speed,
      },
    ],
  },
  law: (f, world) => {
    const { length, rate, speed } = flight.scalesOf(world);
    return `
    <p>Behind a hill of width <var>c</var> and height <var>s</var>₀ the surface falls away. The weight <var>W</var> takes a
      time 1/ω<sub>c</sub> to let the mass <var>m</var> down by half of <var>s</var>₀,</p>
    <p class="formula">ω<sub>c</sub> = √(<var>W</var>/(<var>m</var><var>s</var>₀))</p>
    <p>and the hill takes <var>c</var>/<var>V</var> to pass. If that is the shorter time, the slider is left in the air.
      So one number counts,</p>
    <p class="formula"><var>v</var> = <var>V</var>/(<var>c</var>ω<sub>c</sub>) = (<var>V</var>/<var>c</var>)
      √(<var>m</var><var>s</var>₀/<var>W</var>)</p>
    <p>Here <var>c</var> = ${um(length)} and <var>c</var>ω<sub>c</sub> = ${milli(length * rate)}, so that
      <var>v</var> = ${say(speed)}. If <var>c</var>, the number of summits and the part of the energy that an impact
      takes stay as they are, the whole motion, measured in <var>c</var>, <var>s</var>₀ and 1/ω<sub>c</sub>, follows
      from <var>v</var>. Heights four times as large need half the speed.</p>
    <p>However it hops, the load is the weight on average: what is missing in the air comes back in the impact. No
      formula says how long it is apart: for that you need a simulation.</p>`;
  },
  checks: [
    {
      id: 'leave',
      unit: 'mm/s',
      prompt: `A slider leaves the surface from ${milli(LEAVES)} on. From which speed on, in mm/s, does it leave
        one that is ${HIGHER} times as high and otherwise equal?`,
      expected: () => LEAVES / 1000 / Math.sqrt(HIGHER),
      tolerance: 0.02,
      hints: [
        [() => LEAVES / 1000 / HIGHER, `That is as if <var>V</var><var>s</var>₀ counted. It falls with the root.`],
        [() => (LEAVES / 1000) * Math.sqrt(HIGHER), `Higher hills fall away faster, not slower.`],
        [() => LEAVES / 1000, `The height counts, too: ω<sub>c</sub> has it.`],
      ],
      hint: `<var>V</var>√<var>s</var>₀ is the same in both.`,
    },
    {
      id: 'weight',
      prompt: `The slider is apart for a fifth of the time. What is the mean load while it touches?`,
      options: [
        [`the weight`, `In the air it bears nothing. What makes up for that?`],
        [`1.25 times the weight`],
        [`0.8 times the weight`, `Then it would fall through: the mean over all of the time is the weight.`],
        [`that depends on the speed`, `Look at the second row of the table, at any speed.`],
      ],
    },
  ],
});
