// How many points this browser can draw.

/// What draws; "" where the browser does not say.
export function rendererName(gl: WebGL2RenderingContext): string {
  const info = gl.getExtension("WEBGL_debug_renderer_info");
  return String(gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER) ?? "");
}

export const isSoftware = (renderer: string): boolean => /swiftshader|llvmpipe|software/i.test(renderer);
/// Of what comes live: a machine that draws by software often does the rest of the work, too.
export const liveBudget = (renderer: string): number => (isSoftware(renderer) ? 100_000 : pointBudget(renderer));
export const pointBudget = (renderer: string): number => (isSoftware(renderer) ? 500_000 : 2_000_000);
