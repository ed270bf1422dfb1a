'use strict';
/* What do you see? Asked once a run has gone on for a while; only then does the lesson say what is right. */
(() => {
  const rub = globalThis.rub;
  const { lessons } = rub;
  const { state, page, STEPS } = lessons;
  const { make, part, radio } = page;
  const SECONDS = 10; // at the pace of the experiment
  const FEWEST = 2; // lives

  const needed = ({ experiment: { lives, pace } }) => lives ?? Math.max(FEWEST, Math.ceil(SECONDS * pace));

  lessons.lives = needed;

  /** Return the lives of one step ahead: enough for the second digit of most figures, and for the question. */
  lessons.ahead = ({ experiment }) => Math.max(200, experiment.lives ?? 0);

  /** Return whether enough has been seen to say something: of all runs, of all traces. */
  function enough(lesson, known) {
    if (lesson.experiment.reading) return lessons.reading.isDone(lesson, known);
    const { watched } = known;
    const runs = Object.values(watched).filter((lives) => lives >= needed(lesson));
    return runs.length === lesson.experiment.runs.length;
  }

  /** Note how far the run that was pressed last has come; return whether that has just become enough. */
  function watch(lesson, known) {
    if (known.running < 0 || lessons.kept.running(lesson, known) !== known.running) return false;
    const before = enough(lesson, known);
    const lives = rub.run.reached / rub.exact().lifeMean;
    known.watched[known.running] = Math.max(known.watched[known.running] ?? 0, lives);
    return !before && enough(lesson, known);
  }

  /** Return the question what is seen; none where a teacher has skipped the prediction. */
  function look(lesson, index) {
    const known = state.lessons[index];
    if (known.said === 'skipped') return null;
    const done = lessons.revealed(known);
    const which = lesson.experiment.runs.length > 1 ? 'each run has' : 'the run has';
    const waiting = lesson.experiment.reading
      ? 'Opens when you have read all three traces.'
      : `Opens when ${which} gone on for ${needed(lesson)} lives.`;
    const shut = done || (known.step >= STEPS.run && enough(lesson, known)) ? '' : waiting;
    return part('look', 'What do you see?', shut, shut ? null : done ? said(lesson, known) : form(lesson));
  }

  function said(lesson, { look: seen }) {
    const option = lessons.chosen(lesson, { said: seen });
    const known = state.lessons[lessons.list.indexOf(lesson)];
    const answer = option ? lessons.kept.answer(lesson, known, option) : '';
    return make('p', { html: option ? `You saw: <em>${option.text}</em>. ${answer}` : 'Said.' });
  }

  function form(lesson) {
    const options = lesson.prediction.options.map((each) => radio('observation', each, each.text, false, false));
    const element = make('form', { id: 'lesson-observe', novalidate: true });
    const asks = lesson.evidence?.asks ?? 'What would you say now?';
    element.append(make('fieldset', {}, make('legend', { html: asks }), ...options));
    element.append(make('button', { type: 'submit', text: 'Say so' }));
    element.append(make('p', { class: 'lesson-verdict', role: 'status' }));
    return element;
  }

  Object.assign(lessons, { look, watch });
})();
