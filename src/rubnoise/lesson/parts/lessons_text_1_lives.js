/* Lessons 1 to 3: one life, births at random, the live count. */
const { lessons } = rub;
const { contact } = lessons;
const { say, share, um, um2 } = lessons.words;
const drag = rub.drag.number;

/* Births at random are Poisson. A stretch of n + p regular spacings has n births, or with chance p one more. */
function birthsVariance(f, world) {
  const births = f.lifeMean / f.spacing;
  const part = births % 1;
  return world.births === 'regular' ? part * (1 - part) : births;
}

lessons.add({
  id: 'one-life',
  controls: ['meanArea'],
  title: 'One life',
  question: `Two equal discs of diameter <var>d</var> slide over each other, centre over centre. At full overlap they
    share (π/4) <var>d</var>² = ${say(Math.PI / 4)} <var>d</var>². How large is the area they share on average, from
    first touch to last?`,
  opening: `<svg viewBox="0 0 320 60" role="img" aria-label="Two rough surfaces from the side, touching at three
      hilltops">
    <path class="upper" transform="translate(0 5)" d="M0 0H320V14Q310 24 298 15T272 16Q258 38 244 15T214 14Q202 26 190 16T166 15Q148 38 130 15T102
      13Q90 24 78 15T58 15Q44 38 30 15T0 14Z"/>
    <path class="lower" d="M0 56V42Q14 30 26 40Q36 18 52 40Q66 44 80 40T108 41Q122 40 132 40Q142 18 158 40Q174 44 190
      41T222 40Q232 38 242 40Q252 18 266 40Q284 46 300 40T320 41V56Z"/>
    </svg><canvas id="born" tabindex="0" role="button" aria-label="Let a junction be born"></canvas>
    <figcaption>Click the strip: two hills meet, and a junction is born. From above, hills are circles; where they
      overlap they touch.</figcaption>`,
  prediction: {
    options: [
      { id: 'peak', value: 0.75, text: `nearly the whole disc, about 0.75 <var>d</var>²` },
      { id: 'half', value: 0.39, text: `half of the peak, about 0.39 <var>d</var>²` },
      { id: 'third', value: 0.33, text: `about 0.33 <var>d</var>²`, right: true },
      { id: 'tenth', value: 0.1, text: `about 0.1 <var>d</var>²` },
    ],
  },
  evidence: { run: 0, row: 1, asks: `Which mean area did the disc have over its lives?` },
  needs: { births: 'regular', pulse: 'lens', spread: 0, meanCount: 1 },
  experiment: {
    pace: 0.25, // lives a second
    text: `One junction at a time: each is born where the one before it dies.`,
    runs: [
      {
        label: 'Run one life after another',
        set: contact({ meanArea: 40, meanCount: 1, births: 'regular' }),
        show: 'section area',
      },
    ],
    watch: [
      `The area starts and ends softly and has a sharp top, where the centres meet.`,
      `Choose a junction on the stage: its card has its life curve, its largest area and its mean one.`,
      `Is the trace above the line of the mean for as long as it is below?`,
    ],
    table: [
      { label: 'mean area', unit: 'um^2', value: (v) => v.areaMean },
      { label: 'mean area over <var>d</var>²', value: (v, f) => v.areaMean / f.diameter ** 2 },
    ],
  },
  law: (f) => `
    <p>Cut both discs into thin strips along the sliding direction. At a height <var>y</var> from the centre line a
      strip is <var>w</var> = √(<var>d</var>² − 4<var>y</var>²) long. Two strips of length <var>w</var> that pass each
      other share at most <var>w</var>, rising and falling evenly over a path of 2<var>w</var>: added up over the
      path, <var>w</var>².</p>
    <p class="formula">∫ <var>A</var> d<var>s</var> = ∫ <var>w</var>² d<var>y</var> =
      ∫<sub>−<var>d</var>/2</sub><sup><var>d</var>/2</sup> (<var>d</var>² − 4<var>y</var>²) d<var>y</var> =
      <var>d</var>³ − <var>d</var>³/3 = (2/3) <var>d</var>³</p>
    <p>A life is 2<var>d</var> long, so the mean area over a life is <strong><var>d</var>²/3</strong>:
      ${um2(f.diameter ** 2 / 3)} for the ${um(f.diameter)} of this experiment. Half of the peak would be the answer
      for a triangle; the lens is hollower at both ends. The paper prints 0.327 <var>d</var>², which is 1.9 % low.</p>`,
  checks: [
    {
      id: 'fraction',
      prompt: `The mean area of a junction over its life is which multiple of <var>d</var>²?`,
      expected: () => 1 / 3,
      tolerance: 0.015,
      hints: [
        [
          () => 0.327,
          `0.327 is the rounded figure of the paper (its Eq. 6). The integral gives a simple fraction: (2/3)
            <var>d</var>³ over a life of 2<var>d</var>.`,
        ],
        [() => Math.PI / 4, `That is the largest area, at full overlap.`],
        [() => Math.PI / 8, `That is half of the peak: right for a triangle, but the lens is hollower at both ends.`],
        [() => 2 / 3, `(2/3) <var>d</var>³ is the integral over the life. Divide it by the life, 2<var>d</var>.`],
      ],
      hint: `Divide the integral over a life, (2/3) <var>d</var>³, by the length of the life.`,
    },
    {
      id: 'area',
      unit: 'um^2',
      prompt: (f) =>
        `One disc has a diameter of ${um(2 * f.diameter)}, twice that of the experiment. What is its mean area over
          its life?`,
      expected: (f) => (2 * f.diameter) ** 2 / 3,
      tolerance: 0.02,
      hints: [
        [(f) => (2 * f.diameter ** 2) / 3, `Twice the diameter is more than twice the area.`],
        [(f) => f.diameter ** 2 / 3, `That is the disc of the experiment; this one is twice as wide.`],
      ],
      hint: `The mean is <var>d</var>²/3, with this disc's diameter for <var>d</var>.`,
    },
  ],
});

lessons.add({
  id: 'births',
  controls: ['births', 'meanCount'],
  title: 'Births at random',
  question: `Asperities meet at random places. Say that in every small step of sliding a junction is
    born with the same small chance, whatever happened before. Look at the gaps between one birth and the next: which
    gaps are the most common?`,
  prediction: {
    options: [
      { id: 'mean', text: `those near the mean gap, with shorter and longer ones equally rare` },
      { id: 'short', text: `the shortest ones`, right: true },
      { id: 'all', text: `none: gaps from nothing up to twice the mean are equally common` },
      { id: 'equal', text: `there is but one gap; births keep their distance` },
    ],
  },
  evidence: {
    run: 0,
    row: 1,
    asks: `“Births at random”: which gaps were the most common?`,
    /* Of gaps about the mean hardly any would be so short, of even ones a quarter, of exponential ones 39 %. */
    says: ({ 0: [, short] }) => (short > 0.32 ? 'short' : short > 0.2 ? 'all' : short > 0.02 ? 'mean' : 'equal'),
  },
  needs: {},
  experiment: {
    pace: 1, // lives a second
    lives: 40,
    text: `The same number of births a millimetre, first at random, then at regular distances. Now
      ${drag('meanCount')} junctions of ${drag('diameter')} are alive: drag a number to change it.`,
    runs: [
      { label: 'Births at random', set: contact({ births: 'poisson' }), show: 'beside gaps' },
      { label: 'Regular births', set: contact({ births: 'regular' }), show: 'beside gaps' },
    ],
    watch: [
      `Births at random come in clusters, with long pauses between them, although nothing draws them together.`,
      `The histogram of the gaps: highest at zero, and more than a third of the gaps longer than the mean.`,
      `Both contacts beside each other, on equal axes: a mark for each birth, and the area above. What makes the contact
        noisy is chance.`,
    ],
    table: [
      { label: 'mean gap', unit: 'um', value: (v) => v.spacing },
      {
        label: 'share of gaps shorter than half of the mean',
        seen: (s) => s.gapsBelowHalf,
        exact: (f, world) => (world.births === 'regular' ? 0 : 1 - Math.exp(-1 / 2)),
      },
      {
        label: 'share of gaps longer than the mean',
        seen: (s) => s.gapsBeyondMean,
        exact: (f, world) => (world.births === 'regular' ? 0 : Math.exp(-1)),
      },
      { label: 'births in one life: mean', seen: (s) => s.birthsMean, exact: (f) => f.lifeMean / f.spacing },
      { label: 'births in one life: variance', seen: (s) => s.birthsVariance, exact: birthsVariance },
    ],
  },
  law: (f) => `
    <p>Let births come at the rate λ, one every 1/λ = ${um(f.spacing)} on average. Cut a stretch <var>g</var> into
      <var>n</var> steps; each stays without a birth with chance 1 − λ<var>g</var>/<var>n</var>, and all of them do
      with</p>
    <p class="formula">(1 − λ<var>g</var>/<var>n</var>)<sup><var>n</var></sup> → e<sup>−λ<var>g</var></sup> = P(gap
      &gt; <var>g</var>)</p>
    <p>So gaps are <strong>exponential</strong>: their density λ e<sup>−λ<var>g</var></sup> is highest at 0, and their
      standard deviation is as large as their mean. Of the <var>n</var> steps of a stretch <var>w</var>, each has a
      birth with chance λ<var>w</var>/<var>n</var>, by itself: their number has the mean λ<var>w</var> and the
      variance <var>n</var> (λ<var>w</var>/<var>n</var>)(1 − λ<var>w</var>/<var>n</var>) → λ<var>w</var>. It is a
      <strong>Poisson</strong> number: variance equal to mean. Regular births have equal gaps, and any two stretches
      of one length differ by one birth at most.</p>`,
  checks: [
    {
      id: 'longer',
      prompt: `Births at random: which share of the gaps is longer than the mean gap?`,
      expected: () => Math.exp(-1),
      tolerance: 0.03,
      hints: [
        [
          () => 0.5,
          `Half of the gaps are longer than the <em>median</em>. A few very long gaps pull the mean above it.`,
        ],
        [() => 1 - Math.exp(-1), `That is the share of gaps <em>shorter</em> than the mean.`],
        [() => 0, `That is what regular births would have.`],
      ],
      hint: `P(gap &gt; <var>g</var>) = e<sup>−λ<var>g</var></sup>, and the mean gap is 1/λ.`,
    },
    {
      id: 'swing',
      prompt: () =>
        `On average 100 births fall into a stretch of sliding. By how much does their number typically differ from 100
          (its standard deviation)?`,
      expected: () => Math.sqrt(100),
      tolerance: 0.02,
      hints: [
        [() => 100, `100 is the variance. The standard deviation is its square root.`],
        [() => 0, `That is what regular births would have.`],
        [() => 1, `So little only with regular births.`],
      ],
      hint: `The number of births is Poisson: its variance is its mean.`,
    },
  ],
});

lessons.add({
  id: 'count',
  controls: ['meanCount', 'spread', 'births'],
  title: 'The live count',
  question: `Births at random, each junction alive over twice its diameter, and about 20 alive at any place. By how
    much does the number of live junctions typically differ from 20?`,
  prediction: {
    options: [
      { id: 'one', value: 1, text: `by about 1: births and deaths balance` },
      { id: 'root', value: 4.5, text: `by 4 or 5`, right: true },
      { id: 'ten', value: 10, text: `by about 10` },
      { id: 'all', value: 20, text: `by about 20: it is anything from 0 to 40` },
    ],
  },
  evidence: { run: 0, row: 1, asks: `“Equal sizes”: by how much did the count differ from 20?` },
  needs: { births: 'poisson' },
  experiment: {
    pace: 1, // lives a second
    lives: 30,
    text: `Equal junctions first, then very unequal ones.`,
    runs: [
      { label: 'Equal sizes', set: contact({ spread: 0 }), show: 'count' },
      { label: 'Unequal sizes', set: contact({ spread: 1.5 }), show: 'count' },
    ],
    watch: [
      `Each bar is one life, from birth to death. The count is the number of bars that the line of now crosses.`,
      `The count wanders in the band of one standard deviation about its mean, and is outside it for a third of the
        way.`,
      `Beside the count: how often each number was met so far, in grey, and Poisson's bars.`,
      `Unequal sizes change the length of lives, but the mean and the swing of the count stay nearly the same.`,
    ],
    table: [
      { label: 'mean count', value: (v) => v.countMean },
      { label: 'standard deviation of the count', value: (v) => v.countStd },
      { label: 'mean life over mean gap', value: (v) => v.lifeMean / v.spacing },
    ],
  },
  law: (f) => `
    <p><strong>Little's law.</strong> Over a long path <var>S</var> there are λ<var>S</var> births, and each adds its
      life to the area under the count: ∫ <var>N</var> d<var>s</var> = λ<var>S</var> × mean life. Divide by
      <var>S</var>:</p>
    <p class="formula">mean count = birth rate × mean life = ${um(f.lifeMean)} / ${um(f.spacing)} =
      ${say(f.countMean)}</p>
    <p>It holds for births of any kind. <strong>M/G/∞</strong>: births at random (M, for memoryless), lives of any law
      (G, for general), no limit to the number alive (∞). Of the births at a distance <var>y</var> back, those with a
      life longer than <var>y</var> are still alive; picking some of a random sprinkling by chance leaves a random
      sprinkling, so the count is a Poisson number,</p>
    <p class="formula">variance = mean = λ ∫ P(life &gt; <var>y</var>) d<var>y</var> = λ × mean life</p>
    <p>Only the mean life enters. Standard deviation ${say(f.countStd)}, which is ${share(1 / f.countStd)} of the
      mean.</p>`,
  checks: [
    {
      id: 'little',
      prompt: (f) =>
        `Now there are ${say(f.countMean)} alive on average. Let births come twice as often and lives last three times
          as long: how many then?`,
      expected: (f) => 6 * f.countMean,
      tolerance: 0.02,
      hints: [
        [(f) => 5 * f.countMean, `The factors multiply.`],
        [(f) => 2 * f.countMean, `That is the effect of the births alone.`],
        [(f) => 3 * f.countMean, `That is the effect of the longer lives alone.`],
        [(f) => 1.5 * f.countMean, `Both changes add junctions: more births, and each of them stays longer.`],
      ],
      hint: `Mean count = birth rate × mean life.`,
    },
    {
      id: 'tenth',
      prompt: `Which mean count makes the standard deviation of the count a tenth of the mean?`,
      expected: () => 100,
      tolerance: 0.02,
      hints: [[() => 10, `With 10 it is √10 = ${say(Math.sqrt(10))}, nearly a third of the mean.`]],
      hint: `The standard deviation is √<var>N</var>, so relative to the mean it is 1/√<var>N</var>.`,
    },
  ],
});
