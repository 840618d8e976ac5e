// Runs jobs on the FMUs' WebAssembly modules in node, with the package's JavaScript, and prints the answer as JSON.
//
//     node fmu.mjs PACKAGE_FOLDER < {"job": NAME, "models": {MODEL: [MODULE, DESCRIPTION]}, ...}

import { readFileSync } from "node:fs";
import { pathToFileURL } from "node:url";

const load = (name) => import(`${pathToFileURL(process.argv[2])}/${name}.mjs`);
const { readDescription } = await load("description");
const { Fmu, FmuError, StepDiscarded } = await load("fmi2");
const { sweep } = await load("bench");
const { LineRun } = await load("line");
const { repeatsAfter, meanResponse } = await load("steady");
const { lowPass, statistics } = await load("filter");
const { checked, readSsv, writeSsv } = await load("files");
const { decoded, readMeasured } = await load("measured");
const { staticLoop } = await load("static");
const { raised } = await load("slip");

const given = JSON.parse(readFileSync(0, "utf-8"));
const open = async (model) => {
  const [module, description] = given.models[model];
  return Fmu.load(readFileSync(module), readDescription(readFileSync(description, "utf-8")));
};

/** [kind, message] of what a call throws. */
function thrown(call) {
  try {
    call();
  } catch (error) {
    return [error instanceof StepDiscarded ? "discarded" : error instanceof FmuError ? "refused" : "other", error.message];
  }
  return null;
}

const jobs = {
  descriptions: () =>
    Object.fromEntries(
      Object.entries(given.models).map(([model, [, path]]) => {
        const description = readDescription(readFileSync(path, "utf-8"));
        return [model, { ...description, variables: [...description.variables.values()] }];
      }),
    ),

  steady: () => given.sequences.map((H) => [...repeatsAfter(H, given.tolerance), meanResponse(H.slice(-3))]),

  filter: () => ({
    passed: lowPass(given.series, given.step, given.cutoff),
    statistics: statistics(given.series, given.step, (i) => i >= given.inside[0] && i < given.inside[1]),
  }),

  /** Of each SSV text its values, or the refusal; of the first one what is written again. */
  ssv() {
    const description = readDescription(readFileSync(given.models.ZSpringPantograph[1], "utf-8"));
    const values = given.texts.map((text) => {
      try {
        return readSsv(text, description);
      } catch (error) {
        return error.message;
      }
    });
    return { values, written: writeSsv(values[0], description, "again") };
  },

  /** Of each CSV file, as base64, its curves, or the refusal. */
  measured: () =>
    given.files.map((bytes) => {
      try {
        return readMeasured(decoded(Buffer.from(bytes, "base64")));
      } catch (error) {
        return error.message;
      }
    }),

  colors: async () => (await load("plot")).colors(8),

  /** Refusals of values by name. */
  values() {
    const { variables } = readDescription(readFileSync(given.models.ZSpringPantograph[1], "utf-8"));
    return given.values.map(([name, text]) => thrown(() => checked(variables.get(name), text))?.[1] ?? null);
  },

  async loop() {
    return staticLoop((await open("ZSpringPantograph")).instantiate(), given.parameters, given.amplitude, given.rate);
  },

  async slip() {
    return raised((await open("ZSpringPantograph")).instantiate(), {}, given.frequency, given.amplitudes);
  },

  async figure() {
    const instance = (await open("ZSpringPantograph")).instantiate();
    return given.amplitudes.flatMap((amplitude) => [...sweep(instance, given.parameters, amplitude, given.frequencies)]);
  },

  /** Outputs after each communication step of a run with given inputs. */
  async run() {
    const instance = (await open(given.model)).instantiate();
    const rows = given.inputs.rows;
    const inputs = (row) => Object.fromEntries(given.inputs.names.map((name, i) => [name, row[i]]));
    instance.start(given.parameters, inputs(rows[0]));
    return rows.map((row, i) => {
      instance.set(inputs(row));
      instance.step(i * given.step, given.step);
      return instance.get(given.outputs);
    });
  },

  async refusals() {
    const fmu = await open("ZSpringPantograph"), instance = fmu.instantiate();
    const told = [
      thrown(() => instance.start({ m1: -1 })),
      thrown(() => instance.start({ friction: "Sticky" })),
      thrown(() => instance.start({ "no.such": 1 })),
    ];
    instance.start({ drive: "Bench" }); // a refusal has broken nothing
    return [...told, thrown(() => instance.set({ m1: 7 })), thrown(() => instance.step(0, 0.01))];
  },

  /** A discarded step, the values before and after it, and a step that goes on. */
  async discarded() {
    const answers = {};
    for (const [model, { parameters, input, force, outputs }] of Object.entries(given.cases)) {
      const instance = (await open(model)).instantiate();
      instance.start(parameters);
      instance.step(0, 0.002);
      const before = instance.get(outputs);
      instance.set({ [input]: force });
      const told = thrown(() => instance.step(0.002, 0.1));
      const after = instance.get(outputs);
      instance.set({ [input]: 100 });
      answers[model] = { told, before, after, then: thrown(() => instance.step(0.002, 0.001)) };
    }
    return answers;
  },

  /** The same steps twice, from a state; and memory by handles that are forgotten. */
  async replay() {
    const fmu = await open("ZSpringPantograph"), instance = fmu.instantiate();
    instance.start({ drive: "Bench", "bench.acceleration": 2 });
    instance.step(0, 0.5);
    const state = instance.save();
    const run = () => {
      for (let i = 0; i < 100; ++i) instance.step(0.5 + i / 100, 0.01);
      return instance.get(given.outputs);
    };
    const first = run();
    instance.restore(state);
    const again = run();
    instance.forget(state);
    return [first, again];
  },

  /** Bytes of memory after so many instances, each started, moved, refused something, and freed. */
  async instances() {
    const sizes = {};
    for (const model of Object.keys(given.models)) {
      const fmu = await open(model);
      sizes[model] = given.counts.map((count) => {
        for (let i = 0; i < count; ++i) {
          const instance = fmu.instantiate();
          instance.start(given.parameters[model]);
          instance.step(0, 0.002);
          thrown(() => instance.step(-1, 0.002));
          instance.free();
        }
        return fmu.size;
      });
    }
    return sizes;
  },

  async line() {
    const [catenary, pantograph] = await Promise.all([open("Catenary"), open("ZSpringPantograph")]);
    const run = new LineRun(catenary.instantiate(), pantograph.instantiate(), given.run);
    const forces = [run.force];
    while (forces.length < given.rows) {
      run.advance();
      forces.push(run.force);
    }
    return forces;
  },
};

console.log(JSON.stringify(await jobs[given.job](), (_, value) => (Number.isNaN(value) ? null : value)));
