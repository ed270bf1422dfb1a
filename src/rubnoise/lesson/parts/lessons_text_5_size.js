/* Lesson 9: the size of junctions that are out of sight, read off a trace in three ways. */
const { lessons, reading } = rub;
const { contact } = lessons;
const { say3, share, um } = lessons.words;
const LAG = 3; // um, of the first question
const WIDE = 3; // um, of the one large junction of the second question, among small ones of 1 um
const MANY = 99;
/* A contact in sight, to see what one life looks like. */
const IN_SIGHT = contact({ meanArea: 48, meanCount: 4 });
const run = (label, law, trace) => ({ label, law, trace, set: IN_SIGHT, show: 'reading' });
const part = (power) => WIDE ** power / (WIDE ** power + MANY);

/** Return by how much Rabinowicz's way is off, exactly, for the law of a trace. */
const off = ({ lag, diameter }) => reading.byLag(lag) / diameter;

function law() {
  const traces = ['normal', 'lognormal', 'exponential'].map(reading.of);
  const heavy = reading.heavy(traces[2]);
  return `
    <p>The area here and the area a lag τ on have in common what single junctions bring to both. A life of diameter
      <var>d</var> has areas that go as <var>d</var>² and a length that goes as <var>d</var>, so</p>
    <p class="formula"><var>R</var>(τ) = λ E[∫ <var>A</var>(<var>s</var>) <var>A</var>(<var>s</var> + τ)
      d<var>s</var>] = λ E[<var>d</var>⁵ <var>q</var>(τ/<var>d</var>)]</p>
    <p>Equal junctions have <var>R</var>(τ)/<var>R</var>(0) = 1/2 at τ = ${say3(reading.yardstick)} <var>d</var>. From
      this lag Rabinowicz reads <var>d</var>. But each junction counts with <strong><var>d</var>⁵</strong>: one that is
      twice as wide counts 32 times. So the lag shows the large ones alone, and the mean diameter is read too large,
      exactly <strong>${traces.map((each) => say3(off(each))).join(', ')}</strong> times for the three laws. Of the third
      contact, half of the noise comes from junctions above ${um(Number(heavy.above.toPrecision(3)))}: ${share(
        Number(heavy.share.toPrecision(2)),
      )} of those born.</p>
    <p>The eye does the same: it lies down beside the bumps that stand out. The small junctions are in the trace too, in
      its steep parts: the tail of the spectrum, 4 λ E[<var>d</var>²]/<var>k</var>⁴, counts with <var>d</var>², while its
      flat start counts with <var>d</var>⁶. <code>rubnoise infer</code> fits the whole spectrum. It was given the law of
      sizes and the zero of the sensor, and no more. Its interval holds the truth for 95 of 100 traces, not for every one.</p>`;
}

lessons.add({
  id: 'size',
  controls: [],
  title: 'Read the size off a trace',
  question: `Three friction forces were measured. The autocorrelation of each falls to one half at nearly the same lag,
    from which Rabinowicz (1956) read the size of junctions. On one surface the junctions are nearly equal, on the others
    very unequal. What does this lag show there?`,
  prediction: {
    options: [
      { id: 'mean', text: `their mean diameter: large and small ones balance` },
      { id: 'larger', text: `more than the mean: the large ones make nearly all of the noise`, right: true },
      { id: 'smaller', text: `less than the mean: the small ones are many` },
      { id: 'nothing', text: `nothing about their size: the noise is chance` },
    ],
  },
  needs: {},
  experiment: {
    reading: true,
    pace: 0.5, // lives a second
    text: `Read each trace by eye first. Then the page shows what Rabinowicz's lag and <code>rubnoise infer</code> read
      from it. The stage has another contact, of equal junctions of ${um(6)}: see there what one life looks like.`,
    runs: [
      run('Surface A', 'normal, 20 %', 'normal'),
      run('Surface B', 'lognormal, 50 %', 'lognormal'),
      run('Surface C', 'exponential', 'exponential'),
    ],
    watch: [
      `Look for a bump that stands alone. The bar draws the life of a junction that would be as long: a life is two
        diameters.`,
      `Drag an end of the bar, or the trace along below it; the two sliders do the same.`,
      `Compare the three readings of each trace, and the same reading of all three traces.`,
    ],
    table: [
      { way: 'eye', label: 'by eye', unit: 'um' },
      { way: 'lag', label: 'Rabinowicz’s lag', unit: 'um' },
      { way: 'found', label: 'rubnoise, 95 % interval', unit: 'um' },
      { way: 'truth', label: 'the truth, their mean', unit: 'um' },
    ],
  },
  law,
  checks: [
    {
      id: 'lag',
      unit: 'um',
      prompt: `The autocorrelation of another trace falls to one half at a lag of ${um(LAG)}. All its junctions
        are equal. How large are they?`,
      expected: () => reading.byLag(LAG),
      tolerance: 0.02,
      hints: [
        [() => LAG, `That is the lag. The law says at how many diameters it lies.`],
        [() => LAG * reading.yardstick, `The other way about: the lag is the smaller of the two.`],
        [() => LAG / 2, `A life is two diameters, but this lag is no life: there nothing is left of the correlation.`],
      ],
      hint: `The lag of the half is ${say3(reading.yardstick)} diameters.`,
    },
    {
      id: 'share',
      prompt: `On another surface, one junction in a hundred has a diameter of ${um(WIDE)}, all others of
        ${um(1)}. Which share of the variance of the area comes from the large ones?`,
      expected: () => part(5),
      tolerance: 0.015,
      hints: [
        [() => part(0), `That is their share of the births.`],
        [() => part(1), `That is their share of those in contact. Their areas are larger too.`],
        [() => part(2), `Areas go with the square, and the variance with the square of areas. And lives are longer.`],
        [() => part(3), `That is their share of the mean area.`],
        [() => part(4), `The square of the areas alone. Large ones also live longer.`],
        [() => WIDE ** 5 / 100, `Divide by what large and small ones bring together.`],
      ],
      hint: `Each counts with <var>d</var>⁵: add up what one large junction and ${MANY} small ones bring.`,
    },
  ],
});
