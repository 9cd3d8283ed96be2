// How many points this browser can draw.

/// What draws; "" where the browser does not say.
export function rendererName(gl: WebGL2RenderingContext): string {
  const info = gl.getExtension("WEBGL_debug_renderer_info");
  return String(gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER) ?? "");
}

export const isSoftware = (renderer: string): boolean => /swiftshader|llvmpipe|software/i.test(renderer);
export const pointBudget = (renderer: string): number => (isSoftware(renderer) ? 500_000 : 2_000_000);
