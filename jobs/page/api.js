// Requests to the server. The page's address ends with the token, so relative addresses contain it.
let session = sessionStorage.getItem("session") ?? "";

const request = async (name, options) => {
  try {
    return await fetch(name, options);
  } catch {
    throw new Error("The server does not answer: start swingbank serve again, and open its new address.");
  }
};
async function checked(answer) {
  if (answer.ok) return answer;
  const text = await answer.text();
  let message = text;
  try {
    message = JSON.parse(text).error || text;
  } catch {
    /* plain text */
  }
  throw new Error(message || `the server answered ${answer.status}`);
}
const query = (values = {}) => "?" + new URLSearchParams({ s: session, ...values });
const post = (name, body) =>
  request("api/" + name + query(), { method: "POST", body: JSON.stringify(body) }).then(checked);
const get = (name, values) => request("api/" + name + query(values)).then(checked);

/** Opens this tab's session again, or a new session. Returns {setup, step, steps}. */
export async function open() {
  const answer = await (await post("open", { session })).json();
  session = answer.session;
  sessionStorage.setItem("session", session);
  return answer;
}
/** Waits for the comparison of the submitted model with fitted switching times. Returns {setup, step}. */
export const submitted = async () => (await get("submitted")).json();
export const step = async (k) => (await get("step", { k })).json();
export const effects = async (k) => (await get("effects", { k })).json();
export const curves = async (k, e) => new Float32Array(await (await get("curves", { k, e })).arrayBuffer());
/** Returns the samples of a preview; null if a newer preview has replaced it. */
export async function preview(body) {
  const answer = await post("preview", body);
  return answer.status === 204 ? null : new Float32Array(await answer.arrayBuffer());
}
/** Returns, for each channel, the samples with a parameter 10 % lower, then those with it 10 % higher. */
export const ribbon = async (body) => new Float32Array(await (await post("ribbon", body)).arrayBuffer());
/** Ends a running fit when the page closes. */
export const leave = () => navigator.sendBeacon("api/stop" + query());
export const change = async (body) => (await post("change", body)).json();
export const fit = async (body) => (await post("fit", body)).json();
export const stop = async () => (await post("stop", {})).json();
export const save = async (k) => (await post("save", { step: k })).json();
/** Calls `receive` with every message of a fit, and `lost` with the error if the server no longer answers. */
export function listen(receive, lost) {
  const stream = new EventSource("api/stream" + query());
  stream.onmessage = (m) => receive(JSON.parse(m.data));
  stream.onerror = () => get("step", { k: 0 }).catch(lost);
  return stream;
}
