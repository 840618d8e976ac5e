// Uses the explorer's page as a person does, in a headless browser; prints as JSON what it showed.
//
//     node explore.mjs URL FOLDER [FIREFOX] < {"ssv": TEXT, "csv": TEXT, "broken": TEXT}
//
// FOLDER, FIREFOX: of the browser, see launch.mjs; the screenshot goes into FOLDER as explorer.png.

import { readFileSync } from "node:fs";
import { launch, saved } from "./launch.mjs";

const [, , url, folder, firefox] = process.argv;
const given = JSON.parse(readFileSync(0, "utf-8"));
const browser = await launch(folder, firefox);
const told = { errors: [], requests: [] };
const REFINED = "every 0.125 Hz";

try {
  const page = await browser.newPage({ viewport: { width: 1120, height: 960 }, deviceScaleFactor: firefox ? 1 : 1.25 });
  page.on("pageerror", (error) => told.errors.push(String(error)));
  page.on("console", (message) => {
    if (message.type() === "error" || message.type() === "warning") told.errors.push(message.text());
  });
  page.on("request", (request) => {
    if (!/^(data|blob):/.test(request.url())) told.requests.push(request.url());
  });
  const text = (selector) => page.innerText(selector);
  const rows = (selector) => page.$$eval(`${selector} tr`, (found) => found.map((row) => Array.from(row.cells, (cell) => cell.textContent)));
  const until = (test, ...arguments_) => page.waitForFunction(test, arguments_, { timeout: 120_000 });
  const state = (id, start) => until(([name, expected]) => document.getElementById(name).textContent.startsWith(expected), id, start);
  const save = (button) => saved(page, button, folder, firefox);
  const drop = async (name, content) => {
    const transfer = await page.evaluateHandle(([title, body]) => {
      const made = new DataTransfer();
      made.items.add(new File([body], title));
      return made;
    }, [name, content]);
    await page.dispatchEvent("body", "drop", { dataTransfer: transfer });
  };
  const write = async (field, value) => { // Playwright's fill appends in Firefox
    await page.press(field, "Control+A");
    await page.keyboard.type(value);
  };
  const measured = async () => {
    await page.waitForTimeout(600); // longer than the rest after which it measures anew
    await state("frf-state", REFINED);
  };

  await page.goto(url);
  await until(() => document.documentElement.dataset.ready === "true");
  await state("frf-state", REFINED);
  await until(() => document.getElementById("point-text").textContent.includes("Hz"));
  told.point = await text("#point-text");
  told.synthetic = await text("#synthetic");
  await page.screenshot({ path: `${folder}/explorer.png` });
  const drawn = () => page.$eval("#frf-plot", (canvas) => canvas.toDataURL());
  const magnitudes = await drawn();
  await page.click("#pin");
  await page.selectOption("#frf-shows", "phase");
  told.phase = [await page.evaluate(() => location.hash), (await drawn()) === magnitudes];
  await page.screenshot({ path: `${folder}/phase.png` });
  await page.click("#unpin");
  await page.selectOption("#frf-shows", "magnitude");
  told.phase.push(await page.evaluate(() => location.hash), (await drawn()) === magnitudes);
  told.start = await save("#frf-csv");

  await page.focus("#skip");
  await page.keyboard.press("Enter");
  await page.keyboard.press("Tab");
  told.skipped = await page.evaluate(() => document.activeElement.id);
  await page.focus('[id="slider-zspring.Mf"]'); // the keyboard moves it
  for (let i = 0; i < 40; ++i) await page.keyboard.press("ArrowRight");
  await page.keyboard.press("Tab");
  await measured();
  told.friction = await page.inputValue('[id="value-zspring.Mf"]');
  told.moved = await save("#frf-csv");
  told.command = await page.inputValue("#command");
  await page.focus("#frf-plot");
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("ArrowUp");
  told.keys = [await page.inputValue("#point-amplitude"), await page.inputValue("#point-frequency")];
  await write("#point-frequency", "0.5");
  await page.keyboard.press("Tab");
  await state("point-text", "2 m/s² at 0.5 Hz");
  told.stroke = await text("#point-text");

  await drop("own.ssv", given.ssv);
  await measured();
  told.dropped = await page.inputValue('[id="value-m1"]');
  told.sets = [await page.inputValue("#set")];
  told.written = await save("#save");
  await drop("measured.csv", given.csv);
  await measured();
  told.afterCsv = [await page.isVisible("#message"), await page.inputValue("#amplitudes"), await text("#unmeasure"), await page.inputValue("#low"), await text("#frf-state")];
  await page.selectOption("#frf-shows", "phase");
  told.phase.push(await text("#frf-state"));
  await page.selectOption("#frf-shows", "magnitude");
  told.phase.push(await text("#frf-state"));
  await drop("broken.ssv", given.broken);
  await page.waitForSelector("#message:not([hidden])");
  told.refusal = await text("#message");
  await write('[id="value-m1"]', "-3");
  await page.keyboard.press("Tab");
  await state("message", "m1");
  told.outOfBounds = await text("#message");

  const finished = (id) => until(([name]) => document.getElementById(name).getAttribute("aria-busy") === "false", id);
  await page.selectOption("#set", "dsa-250");
  told.sets.push(await page.inputValue("#set"), await page.inputValue('[id="value-m1"]'));
  told.sliders = [await page.isVisible("#slider-k1"), await page.isVisible('[id="slider-zspring.Mf"]')];
  await page.click("#reset");
  told.sliders.push(await page.isVisible("#slider-k1"), await page.isVisible('[id="slider-zspring.Mf"]'));
  told.sets.push(await page.inputValue("#set"));
  await drop("own line.ssv", given.line);
  await finished("line");
  told.ownLine = [await page.inputValue("#line-set"), await page.inputValue("#command")];
  await page.selectOption("#line-set", "en-50318-2002");
  await write("#speed", "200");
  await page.keyboard.press("Tab");
  told.busy = await page.getAttribute("#line", "aria-busy"); // what is shown is not at 200 km/h
  await finished("line");
  told.statistics = await rows("#statistics");
  told.frames = Number(await page.getAttribute("#place", "max")) + 1;
  told.line = await save("#line-csv");
  await page.click("#sweep");
  await state("sweep-state", "sweep: 33 of 33");
  told.sweep = await save("#sweep-csv");
  await page.click("#pin");
  await write("#last-span", "9");
  await page.keyboard.press("Tab");
  await finished("line");
  told.doubt = await text("#line-state");
  told.swept = [await page.getAttribute("#sweep-result", "aria-busy"), await text("#sweep-state")];
  told.pinned = (await rows("#statistics")).at(-1);
  await write("#uplift", "300");
  await page.keyboard.press("Tab");
  await finished("line");
  told.lifted = await text("#line-state");
  await write("#uplift", "0");
  await page.keyboard.press("Tab");
  await finished("line");
  told.address = await page.evaluate(() => location.hash);

  await page.click("#tab-static");
  await finished("static");
  told.stiffness = await rows("#stiffness");
  await page.click("#tab-slip");
  await finished("slip");
  told.slip = await save("#slip-csv");
  told.onsets = await page.$$eval("#onsets tr", (found) => found.length);
  told.contrast = await page.evaluate(() => {
    const numbers = (color) => color.match(/[\d.]+/g).map(Number);
    const light = (color) => numbers(color).slice(0, 3).map((c) => (c / 255 <= 0.04045 ? c / 255 / 12.92 : ((c / 255 + 0.055) / 1.055) ** 2.4)).reduce((sum, c, i) => sum + [0.2126, 0.7152, 0.0722][i] * c, 0);
    const behind = (e) => (!e ? "rgb(255, 255, 255)" : (numbers(getComputedStyle(e).backgroundColor)[3] ?? 1) > 0 ? getComputedStyle(e).backgroundColor : behind(e.parentElement));
    const texts = Array.from(document.querySelectorAll("body *")).filter((e) => e.checkVisibility() && !e.closest(".stale") && Array.from(e.childNodes).some((n) => n.nodeType === 3 && n.textContent.trim()));
    return texts.map((e) => {
      const [a, b] = [light(getComputedStyle(e).color), light(behind(e))].sort((x, y) => y - x);
      return [(a + 0.05) / (b + 0.05), e.outerHTML.slice(0, 80)];
    }).sort((x, y) => x[0] - y[0])[0];
  });

  await page.goto("about:blank");
  await page.goto(`${url}${told.address}`);
  await until(() => document.documentElement.dataset.ready === "true");
  await finished("line");
  told.again = [await page.inputValue("#speed"), (await rows("#statistics"))[1], await page.evaluate(() => location.hash)];

  await page.setViewportSize({ width: 390, height: 800 });
  await page.click("#tab-frf");
  told.tooWide = await page.evaluate(() => document.documentElement.scrollWidth > window.innerWidth);
  told.unlabelled = await page.$$eval("input, select, textarea, button, canvas", (found) =>
    found.filter((e) => !(e.labels?.length || e.getAttribute("aria-label") || e.textContent.trim())).map((e) => e.id || e.outerHTML),
  );
} finally {
  await browser.close();
}
console.log(JSON.stringify(told));
