// Starts a headless browser, and takes what it saves.

import { mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { chromium, firefox } from "playwright-core";

const QUIET = ["--disable-background-networking", "--disable-sync", "--no-first-run"];

const saves = (folder) => `${folder}/saved`;

/** A Firefox where `own` is its path; else Chromium, on Linux unpacked into the folder. Other systems' own Chrome or Edge. */
export async function launch(folder, own) {
  if (own) { // by WebDriver BiDi
    mkdirSync(saves(folder));
    const firefoxUserPrefs = { "browser.download.alwaysOpenPanel": false }; // which takes the page's focus
    return firefox.launch({ channel: "moz-firefox", executablePath: own, downloadsPath: saves(folder), firefoxUserPrefs });
  }
  if (process.platform !== "linux") return chromium.launch({ channel: process.platform === "win32" ? "msedge" : "chrome" });
  // The package unpacks the libraries it brings only where it believes itself in this environment.
  process.env.AWS_EXECUTION_ENV = "AWS_Lambda_nodejs24.x";
  process.env.TMPDIR = folder;
  const { default: packed } = await import("@sparticuz/chromium");
  packed.setGraphicsMode = false;
  const executablePath = await packed.executablePath();
  // Its own list of places knows only /tmp; without any font, a field for text ends the browser.
  const fonts = `<fontconfig><dir>${folder}/fonts</dir><cachedir>${folder}/fonts-cache</cachedir></fontconfig>`;
  writeFileSync(`${folder}/fonts/fonts.conf`, fonts);
  return chromium.launch({ executablePath, args: ["--no-sandbox", "--no-zygote", "--disable-gpu", ...QUIET] });
}

/** Text of the file that a click on the button saves, in a browser that `launch` started with the same folder and path. */
export async function saved(page, button, folder, own) {
  if (!own) {
    const [file] = await Promise.all([page.waitForEvent("download"), page.click(button)]);
    return readFileSync(await file.path(), "utf-8");
  }
  await page.click(button); // Playwright knows nothing of a Firefox's downloads that are no navigation
  for (let tries = 0; tries < 200; ++tries) {
    const names = readdirSync(saves(folder)), path = `${saves(folder)}/${names[0]}`;
    const text = names.length === 1 ? readFileSync(path, "utf-8") : ""; // two while it is being written
    if (text) {
      rmSync(path);
      return text;
    }
    await page.waitForTimeout(50);
  }
  throw new Error(`${button}: nothing was saved`);
}
