// What the page says of frames, as a browser shows it, against the simulator's truth: check.mjs PAGE.html TRUTH.jsonl FRAME...
import { spawn } from "node:child_process";
import { once } from "node:events";
import { readFileSync } from "node:fs";
import { pathToFileURL } from "node:url";

/// A page has so long to speak; a browser that is stuck has twice that for each.
const LIMIT_MS = 60_000;
const [pageFile, truthFile, ...frames] = process.argv.slice(2);

/// Chromium and how to ask it through its pipe: JSON that ends with a zero, https://chromedevtools.github.io/devtools-protocol.
function open() {
  const browser = spawn("chromium", ["--headless=new", "--no-sandbox", "--disable-gpu", "--remote-debugging-pipe"], {
    stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"],
  });
  const [, , , questions, answers] = browser.stdio;
  // That it has ended says its exit.
  for (const pipe of [questions, answers]) pipe.on("error", () => {});
  const waiting = new Map();
  let unread = "";
  answers.setEncoding("utf8").on("data", (text) => {
    const messages = (unread + text).split("\0");
    unread = messages.pop();
    for (const { id, ...said } of messages.map((message) => JSON.parse(message))) {
      waiting.get(id)?.(said);
      waiting.delete(id);
    }
  });
  let asked = 0;
  const ask = async (method, params = {}, sessionId = undefined) => {
    const id = ++asked;
    questions.write(JSON.stringify({ id, method, params, sessionId }) + "\0");
    const { result, error } = await new Promise((answer) => waiting.set(id, answer));
    if (error) throw new Error(`${method}: ${error.message}`);
    return result;
  };
  return { browser, ask };
}

/// The document once it speaks of a frame, or as it is when the limit is over. The page decodes its pictures beside its own thread: that it
/// has loaded says nothing.
const SPOKEN = `new Promise((spoken) => {
  const look = () => {
    const said = document.getElementById("said")?.textContent;
    if (said || performance.now() > ${LIMIT_MS}) spoken(document.documentElement.outerHTML);
    else setTimeout(look, 20);
  };
  look();
})`;

async function documentOf(ask, frame) {
  const { targetId } = await ask("Target.createTarget", { url: "about:blank" });
  const { sessionId } = await ask("Target.attachToTarget", { targetId, flatten: true });
  await ask("Page.navigate", { url: `${pathToFileURL(pageFile)}#${frame}` }, sessionId);
  const { result } = await ask("Runtime.evaluate", { expression: SPOKEN, awaitPromise: true }, sessionId);
  await ask("Target.closeTarget", { targetId });
  return result.value;
}

/// What the document says in a sentence, if that is of this frame and all of it is true.
function checked(page, frame, there) {
  const text = (html) => html.replace(/<[^>]*>/g, "");
  const said = text(/<p id="said"[^>]*>(.*?)<\/p>/s.exec(page)?.[1] ?? "");
  const body = /<tbody id="rows">(.*?)<\/tbody>/s.exec(page)?.[1] ?? "";
  const rows = [...body.matchAll(/<tr>(.*?)<\/tr>/gs)].map(([, row]) => [...row.matchAll(/<td>(.*?)<\/td>/g)].map(([, cell]) => cell));
  const fail = (reason) => {
    throw new Error(`frame ${frame}: ${reason}\n${said}\n${rows.map((row) => row.join(" | ")).join("\n")}`);
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
  return said;
}

const truths = readFileSync(truthFile, "utf8").split("\n");
const { browser, ask } = open();
const gone = once(browser, "exit").then(([code]) => {
  throw new Error(`chromium ended with ${code} before it had answered`);
});
const look = async () => {
  for (const frame of frames) console.log(checked(await documentOf(ask, frame), frame, JSON.parse(truths[frame - 1]).neighbours));
};
const stuck = new Promise((_, refuse) => {
  setTimeout(() => refuse(new Error("chromium does not answer")), 2 * LIMIT_MS * frames.length).unref();
});
try {
  await Promise.race([look(), gone, stuck]);
} catch (error) {
  console.error(error.message);
  process.exitCode = 1;
} finally {
  gone.catch(() => {});
  browser.kill();
}
