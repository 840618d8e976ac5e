// Workers that share the jobs. Jobs of a kind that are asked for anew take the place of those that still wait.

const LAST = "sweep"; // the kind that all others go before

/** Workers made of this source text, with the FMUs {model: {bytes, description}} loaded. */
export class Pool {
  constructor(source, models, count) {
    const url = URL.createObjectURL(new Blob([source], { type: "text/javascript" }));
    this.waiting = [];
    this.running = new Map(); // by number
    this.number = 0;
    this.workers = Array.from({ length: count }, () => {
      const worker = new Worker(url);
      worker.onmessage = ({ data }) => this.take(worker, data);
      worker.onerror = ({ message }) => console.error(message);
      worker.postMessage({ number: 0, job: "load", given: { models } });
      return worker;
    });
    this.idle = []; // a worker joins by its answer to "load"
    this.ready = new Promise((resolve, reject) => (this.loaded = { resolve, reject }));
  }

  take(worker, { number, answer, error, progress }) {
    if (number === 0) {
      if (error) this.loaded.reject(new Error(error));
      else this.loaded.resolve();
    } else {
      const task = this.running.get(number);
      if (progress) return task.progress?.(progress);
      this.running.delete(number);
      if (error) task.reject(new Error(error));
      else task.resolve(answer);
    }
    this.idle.push(worker);
    this.next();
  }

  next() {
    while (this.idle.length && this.waiting.length) {
      const task = this.waiting.shift(), worker = this.idle.pop();
      this.running.set(task.number, task);
      worker.postMessage({ number: task.number, job: task.job, given: task.given });
    }
  }

  /** Reject what waits of this kind; what runs is finished. */
  drop(kind) {
    const dropped = this.waiting.filter((task) => task.kind === kind);
    this.waiting = this.waiting.filter((task) => task.kind !== kind);
    for (const task of dropped) task.reject(new Error("superseded"));
  }

  /** The answer to a job; rejects with the FMU's message. */
  run(kind, job, given, progress) {
    return new Promise((resolve, reject) => {
      const place = kind === LAST ? -1 : this.waiting.findIndex((task) => task.kind === LAST);
      this.waiting.splice(place < 0 ? this.waiting.length : place, 0, { number: ++this.number, kind, job, given, progress, resolve, reject });
      this.next();
    });
  }
}
