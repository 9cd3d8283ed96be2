import { effect } from "@preact/signals";
import { render } from "preact";
import { takeEmbedded } from "./embedded";
import { startRoute } from "./route";
import { Shell } from "./shell";
import { hello } from "./store";
import { connect } from "./websocket";
import "./test_access";

async function start(): Promise<void> {
  startRoute();
  effect(() => { document.title = hello.value ? `rgbdt ${hello.value.title}` : "rgbdt"; });
  render(<Shell />, document.getElementById("page")!);
  if (takeEmbedded()) return;
  if (import.meta.env.DEV) (await import("./mock")).startMock();
  else connect();
}

void start();
