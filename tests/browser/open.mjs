// Opens a page in a headless browser and prints as JSON what happened and what is there.
//
//     node open.mjs URL FOLDER
//
// FOLDER: for the browser, see launch.mjs.

import { launch } from "./launch.mjs";

const [, , url, folder] = process.argv;
const browser = await launch(folder);
try {
  const page = await browser.newPage();
  const errors = [];
  const requests = [];
  page.on("pageerror", (error) => errors.push(String(error)));
  page.on("console", (message) => {
    if (message.type() === "error" || message.type() === "warning") errors.push(message.text());
  });
  page.on("requestfailed", (request) => errors.push(`failed: ${request.url().slice(0, 80)}`));
  page.on("request", (request) => {
    if (!request.url().startsWith("data:")) requests.push(request.url());
  });
  await page.goto(url, { waitUntil: "networkidle" });
  const found = await page.evaluate(() => ({
    title: document.title,
    headings: Array.from(document.querySelectorAll("h2"), (heading) => heading.textContent),
    images: Array.from(document.images, (image) => ({
      alt: image.alt,
      width: image.complete ? image.naturalWidth : 0,
      height: image.complete ? image.naturalHeight : 0,
    })),
    tables: Array.from(document.querySelectorAll("table"), (table) =>
      Array.from(table.rows, (row) => Array.from(row.cells, (cell) => cell.textContent.trim())),
    ),
    links: Array.from(document.querySelectorAll("[role=main] a"), (link) => link.textContent.trim()),
    tooWide: document.documentElement.scrollWidth > window.innerWidth,
  }));
  console.log(JSON.stringify({ errors, requests, ...found }));
} finally {
  await browser.close();
}
