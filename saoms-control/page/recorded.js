// A fleet whose run has ended, at a moment of it: what was recorded of it, sample by sample.

import { ShownFleet } from "./fleet.js";

/** Samples between two of which the whole table is kept, so that going back is fast. */
const KEPT = 64;
/** Records of a component that the page shows. */
const RECORDS = 2000;

/** The number of entries of a sorted list that are not later than a time. */
export function until(list, time, of = (one) => one) {
  let [low, high] = [0, list.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (of(list[middle]) <= time) low = middle + 1;
    else high = middle;
  }
  return low;
}

export class RecordedFleet extends ShownFleet {
  constructor({ recording, time_s, outcome, name }) {
    super();
    Object.assign(this, { recording, outcome, end: time_s, name });
    this.isFinished = true;
    this.isConnected = true;
    this.times = recording.samples.map(([time]) => time);
    /** What the cells hold at a sample, and at some samples before. */
    this.cells = new Array(recording.cells.length).fill(null);
    this.kept = [];
    this.index = -1;
    /** All records of the component that is followed. */
    this.every = [];
    /** The cells of each subject. */
    this.fields = recording.subjects.map(() => []);
    recording.cells.forEach(([subject, ...path], cell) => this.fields[subject].push({ path, cell }));
    this.owner = recording.cells.map(([subject]) => subject);
    this.told = [];
    const named = new Map();
    for (const { topic, message, by } of recording.subjects) {
      if (topic === undefined) continue;
      if (!named.has(topic)) named.set(topic, { name: topic, kind: "state", message, publishers: [], readers: [] });
      if (!named.get(topic).publishers.includes(by)) named.get(topic).publishers.push(by);
    }
    this.topicList = [...named.values()];
    this.seek(0);
  }

  /** Shows the fleet as it was at a time. */
  seek(time) {
    const now = Math.min(this.end, Math.max(0, time));
    this.#take(Math.max(0, until(this.times, now) - 1));
    const { alerts, log } = this.recording;
    const shown = alerts.filter((alert) => alert.time_s <= now);
    this.alerts = new Map(shown.map((alert) => [alert.id, { ...alert, over_s: alert.over_s > now ? null : alert.over_s }]));
    this.log = log.slice(0, until(log, now, (line) => line.time_s));
    const isOver = now >= this.end;
    this.state = { ...this.state, time_s: now, phase: isOver ? this.outcome.status : "running" };
    this.#records();
    this.dispatchEvent(new CustomEvent("change", { detail: "time" }));
  }

  /** The time of the sample before or after the present one. */
  beside(by) {
    const place = until(this.times, this.state.time_s) - 1;
    if (by < 0) return this.times[Math.max(0, this.times[place] < this.state.time_s ? place : place - 1)];
    return place + 1 < this.times.length ? this.times[place + 1] : this.end;
  }

  /** Brings the table to a sample. */
  #take(wanted) {
    const changed = new Set();
    let from = this.index + 1;
    if (wanted < this.index) {
      const place = Math.floor(wanted / KEPT);
      this.cells = [...this.kept[place]];
      from = place * KEPT + 1;
      this.fields.forEach((_, subject) => changed.add(subject));
    }
    for (let sample = from; sample <= wanted; sample++) {
      const changes = this.recording.samples[sample][1];
      for (let place = 0; place + 1 < changes.length; place += 2) {
        this.cells[changes[place]] = this.#shown(changes[place + 1]);
        changed.add(this.owner[changes[place]]);
      }
      if (sample % KEPT === 0) this.kept[sample / KEPT] ??= [...this.cells];
    }
    this.index = wanted;
    for (const subject of changed) this.#tell(subject);
    // They stay in the order of the document.
    this.components = new Map(this.told.filter(Boolean).map((one) => [one.name, one]));
  }

  /** A value; entries of lists of objects stand elsewhere. */
  #shown(value) {
    const list = value?.["#"];
    return Array.isArray(list) ? list.map((entry) => (typeof entry === "number" ? this.recording.texts[entry] : entry)) : value;
  }

  /** Says of a subject what its cells hold. */
  #tell(subject) {
    const { component, topic, by, key } = this.recording.subjects[subject];
    // A name is a name, whatever the objects of the language know by it.
    const fields = Object.create(null);
    let isThere = false;
    for (const { path, cell } of this.fields[subject]) {
      const value = this.cells[cell];
      if (value === null && path.length > 1) continue;
      isThere ||= value !== null;
      if (path.length === 1) fields[path[0]] = value;
      else (fields[path[0]] ??= Object.create(null))[path[1]] = value;
    }
    if (topic !== undefined) {
      const messages = this.topics.get(topic) ?? new Map();
      this.topics.set(topic, messages);
      if (isThere) messages.set(`${by}/${key}`, { component: by, key, message: fields });
      else messages.delete(`${by}/${key}`);
    } else if (component !== undefined) {
      this.told[subject] = fields.state === null ? null : { values: {}, ...fields, name: component };
    } else {
      this.state = { ...this.state, summaries: fields.summaries ?? [], paused: fields.paused === true };
    }
  }

  /** Follows the records of a component, which are asked for once. */
  async follow({ component = null } = {}) {
    if (component === this.records.component) return;
    this.records = { component, all: [], error: null };
    this.every = [];
    if (component === null) return;
    const answer = await fetch(`records?${new URLSearchParams({ component })}`).catch(() => null);
    const content = await answer?.json().catch(() => null);
    if (this.records.component !== component) return;
    if (answer?.ok) this.every = content;
    else this.records.error = content?.error ?? "The program that shows this has ended: its records cannot be read any more.";
    this.#records();
    this.dispatchEvent(new CustomEvent("change", { detail: "records" }));
  }

  /** The records until the present time. */
  #records() {
    const end = until(this.every, this.state.time_s, (record) => record.time_s);
    this.records.all = this.every.slice(Math.max(0, end - RECORDS), end);
  }

  /** Why a component did what it did before a time, or last. */
  async why(component, at = null) {
    const query = new URLSearchParams({ component, at: `${Math.ceil((at ?? this.state.time_s) * 1e6 + 1)}us` });
    const answer = await fetch(`why?${query}`);
    return { isOk: answer.ok, content: await answer.json() };
  }

  async figures() {
    return this.recording.figures;
  }

  async loadTopics() {
    return this.topicList;
  }

  age() {
    return null;
  }

  isStale() {
    return false;
  }
}
