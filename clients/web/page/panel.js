// The texts of the page: facts, messages, notices with choices, and the card of the point under the pointer.
const LONG_S = 4; // what is waited for longer is named
const SPEAK_MS = 700; // that the card stays the same before it is spoken
const REFUSAL_MS = 4000; // that the message about a refused request stays

export const $ = (id) => document.getElementById(id);

/** A new element with these properties and children. */
export function make(name, properties, ...children) {
  const element = Object.assign(document.createElement(name), properties);
  element.append(...children);
  return element;
}

export const makeButton = (label, onclick) => make('button', { onclick }, label);

function write(id, text) {
  if ($(id).textContent !== text) $(id).textContent = text;
}

let said = ''; // the message, which a refusal may hide
let refusal = 0; // a timer

export function say(text) {
  said = text;
  if (refusal === 0) write('message', text);
}

/** Shows for a while why something was refused; a lost connection is no refusal. */
export function report(error) {
  if (error.code === 'LOST') return;
  write('message', error.message);
  clearTimeout(refusal);
  refusal = setTimeout(() => {
    refusal = 0;
    write('message', said);
  }, REFUSAL_MS);
}

/** Shows facts, {name: value}, in a <dl>. */
export function list(id, facts) {
  $(id).replaceChildren(...Object.entries(facts).flatMap(([name, value]) => [make('dt', {}, name), make('dd', {}, value)]));
}

let noticed = ''; // what the notice says now
let explained = ['', []]; // what it says when no question is asked
let isAsking = false;

function showNotice(text, choices) {
  const now = JSON.stringify([text, ...choices.map(([label]) => label)]);
  if (now === noticed) return;
  noticed = now;
  $('notice').hidden = text === '';
  $('notice').querySelector('p').textContent = text;
  $('notice').querySelector('.buttons').replaceChildren(...choices.map(([label, act]) => makeButton(label, act)));
}

/** Explains what is to be seen, or why nothing is, with choices [[label, act], ...]; an empty text removes the notice. */
export function explain(text, choices = []) {
  explained = [text, choices];
  if (!isAsking) showNotice(text, choices);
}

/** Asks a question, whose choices are as those of explain(). */
export function ask(text, choices) {
  isAsking = true;
  const done = (act) => () => {
    isAsking = false;
    showNotice(...explained);
    act();
  };
  showNotice(text, choices.map(([label, act]) => [label, done(act)]));
}

let speaking = 0; // a timer

/** Shows the card of a point as Pick finds it, beside the point; null: none. Screen readers speak it when it stays. */
export function showCard(found, { width, height }) {
  const card = $('pointer');
  const title = found === null ? '' : (found.name ?? `point ${found.id}`);
  card.hidden = found === null;
  card.querySelector('strong').textContent = title;
  list('point', found?.facts ?? {});
  clearTimeout(speaking);
  if (found === null) return;
  const facts = Object.entries(found.facts).map(([name, value]) => `${name} ${value}`);
  speaking = setTimeout(() => write('spoken', [title, ...facts].join('; ')), SPEAK_MS);
  const place = (at, size, room) => Math.max(4, Math.min(at + 14 + size > room ? at - 14 - size : at + 14, room - size - 4));
  card.style.left = `${place(found.pixels[0], card.offsetWidth, width)}px`;
  card.style.top = `${place(found.pixels[1], card.offsetHeight, height)}px`;
}

/** Shows which colours the values of a field have, {name, min, max}; null: there are no colours. */
export function showLegend(field) {
  $('legend').hidden = field === null;
  if (field === null) return;
  const [least, most] = [field.min, field.max].map((value) => Number(value.toPrecision(4)));
  write('least', `${field.name} ${least}`);
  write('most', String(most));
}

/** Names what has been waited for longer than some seconds, as countWaits returns it. */
export function showWait(wait, other) {
  let text = other;
  if (wait !== null && wait.seconds >= LONG_S) {
    const [what, set = ''] = wait.what.split(' ');
    text = `waiting for ${what === 'AUTH' ? what : `${what} ${set}`}, ${wait.seconds} s, ${(wait.bytes / 1e6).toFixed(1)} MB so far`;
  }
  write('waiting', text);
}

export function fillSelect(select, names, chosen) {
  const now = [...select.options].map((o) => o.value).join('\n');
  if (now !== names.join('\n')) select.replaceChildren(...names.map((name) => new Option(name === '' ? 'none' : name, name)));
  select.value = chosen ?? '';
}
