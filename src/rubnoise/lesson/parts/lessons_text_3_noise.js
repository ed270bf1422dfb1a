/* Lessons 6 and 7: memory, the slider. */
const { lessons } = rub;
const { contact } = lessons;
const { say, um } = lessons.words;
const drag = rub.drag.number;

/* Bartlett: where nothing is left, an estimate over a path S has the variance (2/S) ∫ ρ² dτ. */
let perLife = 0;
function alone(lives) {
  if (!perLife) {
    const f = rub.theory.exact({ ...rub.world, ...contact({}) });
    const cells = 200;
    for (let i = 0; i < cells; i += 1)
      perLife += (f.autocovariance(((i + 0.5) / cells) * f.lifeMean) / f.autocovariance(0)) ** 2 / cells;
  }
  return Math.sqrt((2 * perLife) / lives);
}

lessons.add({
  id: 'memory',
  controls: ['meanCount', 'spread', 'pulse'],
  title: 'Memory',
  question: `The real contact area has just been measured, and it is above its mean. How far must the surface slide
    until the area has nothing to do with that measurement any more?`,
  prediction: {
    options: [
      { id: 'gap', text: `one gap between births` },
      { id: 'half', text: `half a life` },
      { id: 'life', text: `exactly one life`, right: true },
      { id: 'ever', text: `it fades without ever ending` },
    ],
  },
  evidence: {
    run: 0,
    row: 4,
    asks: `Where did the correlation come to nothing but chance?`,
    says: ({ 0: [, quarter, half, , one, later] }, lives) => {
      const chance = 3 * alone(lives);
      if (Math.abs(one) > chance || Math.abs(later) > chance) return 'ever';
      return half > chance ? 'life' : quarter > chance ? 'half' : 'gap';
    },
  },
  needs: { births: 'poisson', pulse: 'lens', spread: 0 },
  experiment: {
    pace: 2, // lives a second
    lives: 1000, // the correlation at half a life then stands 7 times what chance leaves away from 0
    text: `Equal junctions. How strongly is the area correlated with itself, a lag further on?`,
    runs: [{ label: 'Run and compare with itself', set: contact({ spread: 0 }), show: 'memory' }],
    watch: [
      `The trace lies over itself, moved on by a lag. Choose the lag: where both curves are on one side of the mean, it is
        shaded. Beside it is a dot for each place: its area over the area a lag before.`,
      `The correlation falls as the lag grows, and stays near zero from one life on. After ± stands what chance alone
        leaves, which is less in a longer run.`,
      `Press “spectrum” above that picture: flat for waves much longer than a life, then it falls steeply, with dips
        of its own.`,
    ],
    table: [0, 1 / 4, 1 / 2, 3 / 4, 1, 3 / 2].map((lives) => ({
      label: `correlation at a lag of ${lives === 0 ? '0' : lives === 1 ? '1 life' : `${say(lives)} lives`}`,
      seen: (s, f) => rub.estimates.correlation(lives * f.lifeMean),
      exact: (f) => f.autocovariance(lives * f.lifeMean) / f.autocovariance(0),
      chance: lives ? alone : undefined,
    })),
  },
  law: (f) => `
    <p>The area here and the area a lag τ further on have in common only the junctions alive at both places;
      everything else is independent. So</p>
    <p class="formula"><var>R</var>(τ) = λ ∫ <var>A</var>(<var>s</var>) <var>A</var>(<var>s</var> + τ) d<var>s</var>,
      and <var>R</var>(τ) = 0 for τ ≥ 2<var>d</var> = ${um(f.lifeMean)}</p>
    <p>The memory ends <strong>exactly at one life</strong>: Rabinowicz read the size of junctions from a measured
      friction force in this way (1956). The spectrum is the same in other words, <var>S</var>(<var>k</var>) = λ
      |<var>Â</var>(<var>k</var>)|². Long waves see each life as a mere point, hence a flat start: <var>S</var>(0) = λ
      (∫ <var>A</var> d<var>s</var>)². Short waves see the sharp top, where the slope jumps by 2<var>d</var>: a jump
      of slope has the transform 2<var>d</var>/<var>k</var>², so that</p>
    <p class="formula"><var>S</var>(<var>k</var>) → 4 λ <var>d</var>²/<var>k</var>⁴</p>
    <p>up to a swing from the softer corners at birth and death. There is no floor: the constant level the paper
      reports at high wavenumbers comes from how a spectrum is estimated.</p>`,
  checks: [
    {
      id: 'end',
      unit: 'um',
      prompt: (f) => `A friction force was measured elsewhere. Its autocovariance reaches zero at a lag of
        ${um(1.5 * f.lifeMean)} and stays there. How large are the junctions' diameters?`,
      expected: (f) => 0.75 * f.lifeMean,
      tolerance: 0.01,
      hints: [
        [(f) => 1.5 * f.lifeMean, `That is how long a junction lives. Its diameter is not its life.`],
        [(f) => 3 * f.lifeMean, `The other way about: a life is twice the diameter.`],
        [(f) => f.diameter, `That is the contact on the stage, whose memory ends earlier.`],
      ],
      hint: `The memory ends where no junction can be alive at both places. How long is a life?`,
    },
    {
      id: 'tail',
      prompt: `In the tail, at twice the wavenumber: by which factor is the spectral density smaller, on average?`,
      expected: () => [16, 1 / 16],
      tolerance: 0.01,
      hints: [
        [() => 4, `That is the amplitude <var>Â</var>. The density goes with its square.`],
        [() => 1 / 4, `That is the amplitude <var>Â</var>. The density goes with its square.`],
        [() => 8, `The tail is <var>k</var>⁻⁴, not <var>k</var>⁻³.`],
      ],
      hint: `The tail goes as <var>k</var>⁻⁴.`,
    },
  ],
});

lessons.add({
  id: 'slider',
  controls: ['speed', 'mass', 'stiffness', 'damping', 'coupling'],
  title: 'The slider',
  question: `The friction force, strength times area, pushes a mass on a spring with a little damping. The force
    wanders without any rhythm of its own. What does the mass do?`,
  prediction: {
    options: [
      { id: 'copy', text: `it follows the force, a little later` },
      { id: 'ring', text: `it swings in nearly its own rhythm, now more and now less`, right: true },
      { id: 'births', text: `it jumps at each birth` },
      { id: 'still', text: `it settles: what has no rhythm averages out` },
    ],
  },
  evidence: {
    run: 0,
    row: 2,
    asks: `“Fig. 5 as printed”: what did the mass do?`,
    says: ({ 0: [moved, , swings, own] }) =>
      moved < 1 ? 'still' : swings < 0.7 * own ? 'copy' : swings > 1.4 * own ? 'births' : 'ring',
  },
  needs: { births: 'poisson' },
  experiment: {
    sound: 'velocity',
    pace: 7, // lives a second: thirty swings in ten seconds
    measure: true,
    text: `The slider of the paper's Fig. 5, first as printed, then with ten times the damping. It slides at
      ${drag('speed')} over ${drag('meanCount')} junctions: drag a number to change it.`,
    runs: [
      { label: 'Fig. 5 as printed', set: lessons.fig5, show: 'force slider' },
      { label: 'Ten times the damping', set: { ...lessons.fig5, damping: 10 * lessons.fig5.damping }, show: 'force slider' },
    ],
    watch: [
      `The displacement rings although the force does not. Press “measure ten swings”, or drag over the trace: the time
        is nearly the same every time.`,
      `With more damping it rings less. Press ♪ A and ♪ B to hear both on one scale.`,
      `Compare the spread of the slider's velocity with the sliding speed.`,
    ],
    table: [
      { label: 'standard deviation of the displacement', unit: 'um', value: (v) => v.displacementStd },
      {
        label: 'standard deviation of the velocity over sliding speed',
        value: (v, f, world) => v.velocityStd / world.speed,
      },
      /* A Gaussian motion swings std x'/(2π std x) times a second. */
      { label: 'swings a second', unit: 'Hz', value: (v) => v.velocityStd / (2 * Math.PI * v.displacementStd) },
      { label: 'swings a second without any force', unit: 'Hz', value: (v, f) => f.naturalFrequency },
    ],
  },
  law: (f) => `
    <p>A spring-mass system answers each frequency by itself: spectrum of the motion = spectrum of the force ×
      response,</p>
    <p class="formula"><var>S</var><sub>x</sub>(ω) = ψ² <var>S</var>(ω/<var>V</var>)/<var>V</var> × 1/|<var>k</var> −
      <var>m</var>ω² + i<var>c</var>ω|²</p>
    <p>The response has a sharp peak at ω₀ = √(<var>k</var>/<var>m</var>), here ${say(f.naturalFrequency)} Hz. The
      force has a bit of everything; the slider picks its own rhythm out of it. If the force's spectrum is about flat
      across the peak, with the height <var>S</var><sub>F</sub>,</p>
    <p class="formula">Var <var>x</var> ≈ <var>S</var><sub>F</sub>(ω₀)/(2<var>c</var><var>k</var>), Var <var>x</var>′
      ≈ <var>S</var><sub>F</sub>(ω₀)/(2<var>c</var><var>m</var>)</p>
    <p>Little damping, much vibration. All of this takes the sliding distance as <var>V</var><var>t</var>, as if the
      slider's own motion did not count. That is fair while its velocity is small beside <var>V</var>. Exactly, the
      standard deviation of the velocity is <strong>${say(f.oneWay)} times the sliding speed</strong>, so constant
      speed is ${f.oneWay < 0.1 ? 'a fair assumption here' : 'no fair assumption here'}.
      ${f.oneWay < 0.1 ? '' : 'What the slider does once it counts is asked in lesson 12.'}
      The faster the sliding, the fairer: a flat spectrum makes the ratio fall as <var>V</var><sup>−3/2</sup>.</p>`,
  checks: [
    {
      id: 'rhythm',
      unit: 'Hz',
      prompt: (f, world) => `The spring stays, ${say(world.stiffness)} N/m, and the mass is made four times as large,
        ${say(4 * world.mass)} kg. At which frequency does the slider ring then, in Hz?`,
      expected: (f) => f.naturalFrequency / 2,
      tolerance: 0.02,
      hints: [
        [(f) => Math.PI * f.naturalFrequency, `That is ω₀ in rad/s. One turn is 2π.`],
        [(f) => f.naturalFrequency, `That is the mass on the stage.`],
        [(f) => f.naturalFrequency / 4, `The frequency goes with the root of the mass.`],
        [(f) => 2 * f.naturalFrequency, `A heavier mass swings more slowly.`],
      ],
      hint: `ω₀ = √(<var>k</var>/<var>m</var>) with the mass in kg, and the frequency is ω₀/(2π).`,
    },
    {
      id: 'fair',
      prompt: () =>
        `Change the controls until constant sliding speed is a fair assumption: the velocity's standard deviation below a
          tenth of the sliding speed. Then check.`,
      met: (f) => f.oneWay < 0.1,
      hint: (f) =>
        `It is ${say(f.oneWay)} times the sliding speed now. Which control makes the junctions come and go too quickly
          for the slider to follow?`,
    },
  ],
});
