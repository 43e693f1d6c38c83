// What the page says of a frame (its document on standard input) against the simulator's truth: check.mjs TRUTH.jsonl FRAME
import { readFileSync } from "node:fs";

const [truthFile, frame] = process.argv.slice(2);
const page = readFileSync(0, "utf8");
const text = (html) => html.replace(/<[^>]*>/g, "");
const said = text(/<p id="said"[^>]*>(.*?)<\/p>/s.exec(page)?.[1] ?? "");
const body = /<tbody id="rows">(.*?)<\/tbody>/s.exec(page)?.[1] ?? "";
const rows = [...body.matchAll(/<tr>(.*?)<\/tr>/gs)].map(([, row]) => [...row.matchAll(/<td>(.*?)<\/td>/g)].map(([, cell]) => cell));
const there = JSON.parse(readFileSync(truthFile, "utf8").split("\n")[frame - 1]).neighbours;

const fail = (reason) => {
  console.error(`frame ${frame}: ${reason}\n${said}\n${rows.map((row) => row.join(" | ")).join("\n")}`);
  process.exit(1);
};
if (!said.startsWith(`frame ${frame} of `)) fail("the page does not speak of it");
if (rows.length !== there.length) fail(`${there.length} neighbours are there`);
for (const { distance_m: truth, position_m: [x, , z] } of there) {
  const deg = (180 / Math.PI) * Math.atan2(x, z);
  const azimuth = ([, , , , bearing]) => Number.parseFloat(bearing) * (bearing.includes("left") ? -1 : 1);
  const row = rows.find((row) => Math.abs(azimuth(row) - deg) < 2);
  if (!row) fail(`nobody is at ${deg.toFixed(1)} deg`);
  const [estimate, sigma] = [Number(row[1]), Number(row[2])];
  const [least, most] = row[3].split(" to ").map(Number);
  if (!(Math.abs(estimate - truth) < 4 * sigma + 0.01)) fail(`${truth.toFixed(2)} m is farther than 4 sigma from ${estimate} m`);
  if (!(least - 0.01 <= truth && truth <= most + 0.01)) fail(`${truth.toFixed(2)} m is not within the bounds`);
}
console.log(said);
