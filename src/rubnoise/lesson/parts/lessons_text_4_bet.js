/* Lesson 8: many small or few large, with a bet. */
const { lessons } = rub;
const { contact } = lessons;
const { say, share, um2 } = lessons.words;
/* A soft metal on a heavy slider of damping ratio 0.05: constant speed is a fair assumption for the bet. */
const HEAVY = { speed: 1000, strength: 40, mass: 0.5, stiffness: 30000, damping: 12.25 };
const FEW = 5;
const MANY = 80;
const side = (meanCount) => ({ ...contact({ meanCount }), ...HEAVY });

/** Return the settings of the bet's two contacts, with the knobs that the bet leaves alone. */
const sides = (world) => [FEW, MANY].map((meanCount) => ({ ...world, ...contact({ meanCount }) }));

/** Return a quantity of the few over that of the many, exactly. */
function ratioOf(quantity, world) {
  const [few, many] = sides(world).map((settings) => rub.theory.exact(settings)[quantity]);
  return few / many;
}

/** Return how a bet ends: what both contacts show over many lives, and who wins. */
function settle({ said, stake }, world) {
  const [few, many] = sides(world)
    .map((settings) => lessons.measured(settings))
    .map((seen) => seen.areaStd / seen.areaMean);
  const shown = `Over ${lessons.MOST_LIVES} lives each, the area of the few strays by ${share(few)} of its mean, that
    of the many by ${share(many)}: <strong>${say(few / many)} to one</strong>.`;
  if (!stake) return shown;
  const won = lessons.kept.nearest(BETS, few / many).id === said;
  return `${shown} ${won ? `You win ${stake} chips!` : `Your ${stake} chips are lost.`}`;
}

const BETS = [
  { id: 'many', text: `the many: more births, more noise`, value: 1 / 4 },
  { id: 'same', text: `neither: the mean area is the same`, value: 1 },
  { id: 'twice', text: `the few, about twice as noisy`, value: 2 },
  { id: 'four', text: `the few, about 4 times as noisy`, value: 4, right: true },
  { id: 'sixteen', text: `the few, about ${MANY / FEW} times as noisy`, value: MANY / FEW },
];

lessons.add({
  id: 'bet',
  controls: ['meanArea', 'meanCount', 'speed'],
  title: 'Many small or few large',
  question: `Two contacts have the same mean real contact area: one of ${FEW} large junctions, one of ${MANY} small
    ones. Which of them is noisier, and how many times? Place a bet before you see it.`,
  prediction: { stake: true, options: BETS },
  evidence: {
    run: 0,
    row: 0,
    asks: `Which of the two was noisier, and how many times?`,
    says: ({ 0: few, 1: many }) => lessons.kept.nearest(BETS, few[0] / many[0]).id,
  },
  needs: { births: 'poisson', pulse: 'lens' },
  experiment: {
    sound: 'velocity',
    pace: 1, // lives a second
    text: `One after the other, over many lives each. The bet is settled by what the two runs show, not by the
      formula.`,
    runs: [
      { label: `${FEW} large junctions`, set: side(FEW), show: 'beside area' },
      { label: `${MANY} small junctions`, set: side(MANY), show: 'beside area' },
    ],
    watch: [
      `Both contacts beside each other, on equal axes: that of the few goes up and down in large steps, that of the many
        hums along its mean.`,
      `Press ♪ A and ♪ B: both on one scale. Which is louder?`,
    ],
    table: [
      { label: 'standard deviation of the area over its mean', value: (v) => v.areaStd / v.areaMean },
      { label: 'standard deviation of the displacement', unit: 'um', value: (v) => v.displacementStd },
    ],
  },
  settle,
  law: (f, world) => `
    <p>By Campbell's theorem the standard deviation is ${lessons.swing().toFixed(4)}/√<var>N</var> of the mean, so at
      the same mean area</p>
    <p class="formula">few / many = √(${MANY}/${FEW}) = ${say(Math.sqrt(MANY / FEW))}</p>
    <p>A large junction is a large piece that comes and goes at once; many small ones come and go independently, and
      their ups and downs cancel, all but a share of 1/√<var>N</var>. This is the paper's conclusion, as a law. On the
      stage now: ${share(f.areaStd / f.areaMean)} of ${um2(f.areaMean)}.</p>
    <p>The slider feels the difference too: exactly ${say(ratioOf('displacementStd', world))} to one in the standard
      deviation of its displacement. Smaller junctions also live shorter lives, which spreads the noise over higher
      frequencies: <var>S</var>(0) = λ(∫ <var>A</var> d<var>s</var>)² = (2/9) <var>N</var> <var>d</var>⁵ falls as
      <var>N</var><sup>−3/2</sup>, by ${say((MANY / FEW) ** 1.5)} from ${FEW} to ${MANY}. So the spectrum does depend
      on number and size, in level and in corner; the paper took the two for negligible.</p>`,
  checks: [
    {
      id: 'factor',
      prompt: () =>
        `A surface is made rougher so that, at the same mean area, there are 40 junctions instead of 10. By which
          factor does the standard deviation of the area fall?`,
      expected: () => [2, 1 / 2],
      tolerance: 0.01,
      hints: [
        [() => 4, `Four times as many, but independent: only the variance falls so much.`],
        [() => 1 / 4, `Four times as many, but independent: only the variance falls so much.`],
        [() => 16, `That is the square of the ratio; it takes the root.`],
      ],
      hint: `It goes as 1/√<var>N</var>.`,
    },
    {
      id: 'why',
      prompt: `Why are many small junctions quieter?`,
      options: [
        [
          `a small junction is weaker, so the mean force is smaller`,
          `The mean area is the same, and with it the mean force.`,
        ],
        [`they come and go independently, and their ups and downs mostly cancel`],
        [
          `they come and go too fast to be noticed by the area`,
          `The area counts every one of them, whatever their speed.`,
        ],
        [`many junctions arrange themselves more regularly`, `Their births are as random as ever.`],
      ],
    },
  ],
});
