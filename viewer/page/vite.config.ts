import { defineConfig, type Plugin } from "vite";

// What the bridge sends as a header stands in the file, too, so that it holds for a report opened
// without a server.
const kPolicy = "default-src 'none'; script-src 'unsafe-inline' blob:; style-src 'unsafe-inline'; " +
  "img-src blob: data:; connect-src 'self' ws:; worker-src blob:";

/// HTML ends a script at the first "</script", even within a string. After "<!--", "<script" begins
/// another one; both may be code, so that they cannot be written otherwise.
function inScript(code: string): string {
  if (code.includes("<!--") && /<script/i.test(code)) throw new Error("the script holds <!-- and <script");
  return code.replace(/<\/script/gi, "\\x3C/script");
}

/// All scripts and styles into index.html: the page is one file and asks for no other.
function oneFile(): Plugin {
  return {
    name: "one-file",
    enforce: "post",
    apply: "build",
    generateBundle(_options, bundle) {
      const page = Object.values(bundle).find((part) => part.fileName === "index.html");
      if (page?.type !== "asset") throw new Error("no index.html in the bundle");
      let html = String(page.source);
      for (const part of Object.values(bundle)) {
        if (part === page) continue;
        const name = part.fileName.replace(/[.*+?^${}()|[\]\\]/g, "\\$&");
        const [tag, inline] = part.type === "chunk"
          ? [new RegExp(`<script[^>]*src="[^"]*${name}"[^>]*></script>`),
            `<script type="module">${inScript(part.code)}</script>`]
          : [new RegExp(`<link[^>]*href="[^"]*${name}"[^>]*>`), `<style>${String(part.source)}</style>`];
        if (!tag.test(html)) throw new Error(`index.html has no place for ${part.fileName}`);
        html = html.replace(tag, () => inline);
        delete bundle[part.fileName];
      }
      page.source = html.replace("<head>", `<head>\n    <meta http-equiv="Content-Security-Policy" content="${kPolicy}">`);
    },
  };
}

export default defineConfig({
  base: "./",
  esbuild: { jsx: "automatic", jsxImportSource: "preact", legalComments: "none" },
  build: {
    target: "es2022",
    assetsInlineLimit: Number.MAX_SAFE_INTEGER,
    cssCodeSplit: false,
    modulePreload: false,
    chunkSizeWarningLimit: 2000, // [kB]
    rollupOptions: { output: { inlineDynamicImports: true } },
  },
  plugins: [oneFile()],
});
