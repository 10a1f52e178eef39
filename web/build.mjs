// Bundle the explorer and the live page: `node build.mjs` writes the assets, `--check` compares them byte for byte.
import { readFileSync, writeFileSync } from "node:fs";
import { basename, dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const here = dirname(fileURLToPath(import.meta.url));
const place = (...parts) => join(here, "..", "trackroller", ...parts, "assets");

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

async function bundled(main, look, words) {
  const script = await build({ ...options, entryPoints: [main] });
  const style = await build({ ...options, entryPoints: [look] });
  const kept = Object.entries(Object.values(script.metafile.outputs)[0].inputs).filter(([, { bytesInOutput }]) => bytesInOutput > 0);
  const text = `/*! ${words} of trackroller (MIT) with\n${licences(kept.map(([path]) => path))}\n*/\n${script.outputFiles[0].text}`;
  if (/<\/script|<!--/i.test(text)) throw new Error("the script would end its own element");
  return [text, style.outputFiles[0].text];
}

const explorer = await bundled("src/main.js", "src/explorer.css", "The explorer");
const app = await bundled("src/app/main.js", "src/app/app.css", "The live page");
const files = {
  [join(place("report", "explorer"), "explorer.js")]: explorer[0],
  [join(place("report", "explorer"), "explorer.css")]: explorer[1],
  [join(place("app"), "app.js")]: app[0],
  [join(place("app"), "app.css")]: app[1],
};

let stale = 0;
for (const [path, text] of Object.entries(files)) {
  const name = basename(path);
  if (process.argv.includes("--check")) {
    if (readFileSync(path, "utf8") !== text) {
      console.error(`${name} is not what web/src gives: run \`make explorer\``);
      stale = 1;
    }
  } else writeFileSync(path, text);
  console.log(`${name}: ${Math.round(Buffer.byteLength(text) / 1024)} kB`);
}
process.exit(stale);
