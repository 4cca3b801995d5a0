// The server's events, and the way back to it once it was away.

const RETRY_MS = 1000;
/** The server says something every ten seconds at least. */
const SILENCE_MS = 25000;

/**
 * Listens to topics for ever: handlers[topic](value). `onLink(isUp, why)` is told when the link comes and goes.
 */
export function listen(topics, handlers, onLink) {
  let silence = 0;
  const open = () => {
    const source = new EventSource("events");
    const close = (why) => {
      clearTimeout(silence);
      source.close();
      onLink(false, why);
      setTimeout(open, RETRY_MS);
    };
    const heard = () => {
      clearTimeout(silence);
      silence = setTimeout(() => close("the server is silent"), SILENCE_MS);
    };
    source.onopen = () => {
      heard();
      onLink(true, "");
    };
    source.onerror = () => close("no server, or as many viewers as it takes");
    for (const topic of topics) {
      source.addEventListener(topic, (event) => {
        heard();
        handlers[topic](JSON.parse(event.data));
      });
    }
  };
  open();
}

/** As `fetch`; where there is no server it says so in words. */
export async function fetched(path, options) {
  try {
    return await fetch(path, options);
  } catch {
    throw new Error("the server does not answer");
  }
}
