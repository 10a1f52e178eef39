// Bundle the explorer: `node build.mjs` writes the assets, `node build.mjs --check` compares them byte for byte.
import { readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const here = dirname(fileURLToPath(import.meta.url));
const assets = join(here, "..", "trackroller", "report", "explorer", "assets");

// Licences of the bundled packages: they travel inside every report.
function licences(inputs) {
  const names = [...new Set(inputs.map((path) => /node_modules\/((?:@[^/]+\/)?[^/]+)/.exec(path)?.[1]).filter(Boolean))].sort();
  const texts = new Map();
  for (const name of names) {
    const { version, license } = JSON.parse(readFileSync(join(here, "node_modules", name, "package.json"), "utf8"));
    const text = readFileSync(join(here, "node_modules", name, "LICENSE"), "utf8").trim();
    texts.set(text, [...(texts.get(text) ?? []), `${name} ${version} (${license})`]);
  }
  return [...texts].map(([text, told]) => `${told.join(", ")}\n\n${text}`).join("\n\n---\n\n");
}

const options = {
  bundle: true,
  minify: true,
  charset: "utf8",
  format: "iife",
  target: ["chrome100", "firefox100", "safari15.4"],
  legalComments: "none",
  write: false,
  metafile: true,
  absWorkingDir: here,
  logLevel: "warning",
};
const script = await build({ ...options, entryPoints: ["src/main.js"] });
const style = await build({ ...options, entryPoints: ["src/explorer.css"] });
const kept = Object.entries(Object.values(script.metafile.outputs)[0].inputs).filter(([, { bytesInOutput }]) => bytesInOutput > 0);
const notice = licences(kept.map(([path]) => path));
const files = {
  "explorer.js": `/*! The explorer of trackroller (MIT) with\n${notice}\n*/\n${script.outputFiles[0].text}`,
  "explorer.css": style.outputFiles[0].text,
};
if (/<\/script|<!--/i.test(files["explorer.js"])) throw new Error("the script would end its own element");

let stale = 0;
for (const [name, text] of Object.entries(files)) {
  const path = join(assets, name);
  if (process.argv.includes("--check")) {
    if (readFileSync(path, "utf8") !== text) {
      console.error(`${name} is not what web/src gives: run \`make explorer\``);
      stale = 1;
    }
  } else writeFileSync(path, text);
  console.log(`${name}: ${Math.round(Buffer.byteLength(text) / 1024)} kB`);
}
process.exit(stale);
