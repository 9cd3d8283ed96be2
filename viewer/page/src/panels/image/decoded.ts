import { useEffect, useRef, useState } from "preact/hooks";

/// The newest image of these that could be decoded. While one is decoded, those between it and the
/// newest are left out: a slow browser shows fewer images, not older and older ones.
export function useDecoded(url: string | undefined): HTMLImageElement | null {
  const [shown, setShown] = useState<HTMLImageElement | null>(null);
  const wanted = useRef<string | undefined>(undefined);
  const busy = useRef(false);
  wanted.current = url;

  useEffect(() => {
    const next = (): void => {
      const now = wanted.current;
      if (busy.current || now === undefined) return;
      busy.current = true;
      const image = new Image();
      image.src = now;
      image.decode().then(() => setShown(image), () => undefined).finally(() => {
        busy.current = false;
        if (wanted.current !== now) next();
      });
    };
    if (url === undefined) setShown(null);
    next();
  }, [url]);
  useEffect(() => () => { wanted.current = undefined; }, []);
  return shown;
}
