import { afterEach, expect, test } from "vitest";
import type { Hello } from "../src/protocol";
import { tabs } from "../src/route";
import { connection, hello } from "../src/store";

const said = (source: Hello["source"]): Hello => ({ type: "hello", source, title: "", version: "", may_command: false, why_not: "" });
const names = () => tabs.value.map(({ id }) => id);
afterEach(() => { [connection.value, hello.value] = ["connecting", null]; });

test("a bus has all tabs", () => {
  [connection.value, hello.value] = ["open", said("live")];
  expect(names()).toEqual(["cloud", "cameras", "session", "pick", "bus"]);
});

test("a finished session, by a bridge or in a report, has none that is dead", () => {
  [connection.value, hello.value] = ["open", said("session")];
  expect(names()).toEqual(["cloud", "cameras", "session"]);
  [connection.value, hello.value] = ["embedded", null];
  expect(names()).toEqual(["cloud", "cameras", "session"]);
});
