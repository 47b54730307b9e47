// The fleet as the server tells it: one stream of events, from which all parts of the page take what they show.

/** Time without any event after which the connection counts as lost: the server looks at the fleet each 0.4 s. */
const SILENCE_MS = 6000;
/** Lines of the log, and records of a component, that the page keeps. */
const LINES = 1000;
const RECORDS = 2000;
/** Messages of an event topic that the page keeps. */
const EVENTS = 200;

/** What parts of a page show of a fleet, running or not. */
export class ShownFleet extends EventTarget {
  constructor() {
    super();
    /** The run: name, process, composites. */
    this.about = null;
    /** Phase, time, pause and summaries. */
    this.state = { time_s: 0, phase: "connecting", paused: false, speed: null, summaries: [] };
    /** Components by their paths, in their order. */
    this.components = new Map();
    /** Messages of state topics by topic, then by component and key; of event topics the newest ones. */
    this.topics = new Map();
    this.received = 0;
    /** What `/v1/topics` says. */
    this.topicList = [];
    this.alerts = new Map();
    this.log = [];
    this.records = { component: null, all: [], error: null };
    this.isConnected = false;
  }

  /** Alerts that nobody has acknowledged, and that are not over. */
  waiting() {
    return [...this.alerts.values()].filter((alert) => alert.over_s === null && alert.acknowledged === null);
  }
}

/** A fleet that runs. */
export class Fleet extends ShownFleet {
  constructor() {
    super();
    this.heard = 0;
    this.source = null;
    this.wants = { topics: [], component: null };
    setInterval(() => this.#watch(), 500);
  }

  /** Follows these topics and the records of this component, beside what is always told. */
  follow({ topics = [], component = null } = {}) {
    const wants = { topics: [...topics].sort(), component };
    if (this.source && JSON.stringify(wants) === JSON.stringify(this.wants)) return;
    if (component !== this.records.component) this.records = { component, all: [], error: null };
    this.wants = wants;
    this.#open();
  }

  #open() {
    this.source?.close();
    const query = new URLSearchParams({ lines: "300" });
    if (this.wants.topics.length) query.set("topics", this.wants.topics.join(" "));
    if (this.wants.component) query.set("component", this.wants.component);
    const source = new EventSource(`/v1/stream?${query}`);
    this.source = source;
    const on = (name, take) =>
      source.addEventListener(name, (event) => {
        this.#hears();
        take(JSON.parse(event.data));
        this.dispatchEvent(new CustomEvent("change", { detail: name }));
      });
    // After a connection was lost, all that comes first is told again.
    source.addEventListener("open", () => {
      this.log = [];
      this.#hears();
    });
    on("status", (status) => this.#status(status));
    on("topic", (topic) => this.#topic(topic));
    on("alerts", (alerts) => (this.alerts = new Map(alerts.map((alert) => [alert.id, alert]))));
    on("alert", ({ alert }) => this.alerts.set(alert.id, alert));
    on("log", (line) => {
      this.log.push(line);
      if (this.log.length > LINES) this.log.splice(0, this.log.length - LINES);
    });
    on("records", (found) => this.#records(found));
    on("lost", () => {});
    source.addEventListener("error", () => {
      if (source !== this.source) return;
      this.#loses();
      // A server that refuses is not asked again by the browser.
      if (source.readyState === EventSource.CLOSED) setTimeout(() => this.#again(source), 2000);
    });
  }

  async #again(source) {
    if (source !== this.source) return;
    try {
      const answer = await fetch("/v1/session");
      if (answer.status === 401) return location.assign("/login");
    } catch {
      // It is not there.
    }
    this.#open();
  }

  #hears() {
    this.heard = performance.now();
    if (this.isConnected) return;
    this.isConnected = true;
    this.dispatchEvent(new Event("connection"));
  }

  #loses() {
    if (!this.isConnected) return;
    this.isConnected = false;
    this.dispatchEvent(new Event("connection"));
  }

  #watch() {
    if (this.isConnected && performance.now() - this.heard > SILENCE_MS) this.#loses();
  }

  #status(status) {
    const { components, all, fleet, ...state } = status;
    if (fleet) {
      // Another run has the address now: nothing of the one before counts any more.
      if (this.about && (this.about.pid !== fleet.pid || this.about.started !== fleet.started)) return location.reload();
      this.about = fleet;
    }
    this.state = state;
    if (all) this.components = new Map(components.map((one) => [one.name, this.components.get(one.name) ?? {}]));
    for (const one of components) Object.assign(this.components.get(one.name), one);
  }

  #topic({ topic, messages }) {
    const known = this.topics.get(topic) ?? new Map();
    this.topics.set(topic, known);
    const isEvent = this.topicList.find((one) => one.name === topic)?.kind === "event";
    for (const one of messages) {
      this.received += 1;
      known.set(isEvent ? this.received : `${one.component}/${one.key}`, one);
      if (isEvent && known.size > EVENTS) known.delete(known.keys().next().value);
    }
  }

  #records({ records = [], error = null }) {
    this.records.error = error;
    const last = this.records.all.at(-1)?.id ?? 0;
    this.records.all.push(...records.filter((record) => record.id > last));
    if (this.records.all.length > RECORDS) this.records.all.splice(0, this.records.all.length - RECORDS);
  }

  /** The plots and their figures from the start of the run; those after a time alone. */
  async figures(after = null) {
    const answer = await fetch(after === null ? "/v1/figures" : `/v1/figures?after=${after}`);
    return answer.ok ? answer.json() : null;
  }

  /** Why a component did what it did before a time in seconds, or last: the status of the answer, and what it says. */
  async why(component, at = null) {
    const query = new URLSearchParams({ component });
    // A bare number is milliseconds; the record itself is to be among what is explained.
    if (at !== null) query.set("at", `${Math.ceil(at * 1e6 + 1)}us`);
    const answer = await fetch(`/v1/why?${query}`);
    return { isOk: answer.ok, content: await answer.json() };
  }

  /** Asks for the topics of the fleet. */
  async loadTopics() {
    const answer = await fetch("/v1/topics");
    if (answer.ok) this.topicList = await answer.json();
    return this.topicList;
  }

  /** Seconds since a component said how it is; `null` if it never did. */
  age(component) {
    return component.values_s === null || component.values_s === undefined
      ? null
      : Math.max(0, this.state.time_s - component.values_s);
  }

  /** True if what a component says of itself is so old that it may be wrong. */
  isStale(component) {
    const age = this.age(component);
    return component.state === "running" && age !== null && age > Math.max(5, ((component.period_ms ?? 0) * 20) / 1000);
  }
}
