#!/usr/bin/env bash
# One record in the formats of instruments, historians and spreadsheets: units of time, time stamps, words for missing
# values, separators, frames of zeros, phases, COMTRADE of each revision. The comparison must equal that of the plain
# record; unreadable files are refused with one message each.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"

networks=$SWINGBANK_SOURCE/configs/networks/ieee39_dataset_genrou
{
  "$swingbank" plant --raw "$networks.raw" --dyr "$networks.dyr" --bus 32 2>/dev/null
  "$swingbank" effects --toml SEXS TGOV1
} >"$work/plant.toml"
"$swingbank" simulate --raw "$networks.raw" --dyr "$networks.dyr" --attach all:SEXS --attach all:TGOV1 --rate 60 --t-end 8 \
  --plants 32 --channels P,Q --buses 32 --fault 14:2:2.1 --out "$work/run.csv" >/dev/null 2>&1 || fail "simulate"

python3 - "$work" <<'PY'
import cmath, csv, datetime, math, random, struct, sys
from pathlib import Path

work = Path(sys.argv[1])
(work / "read").mkdir()
(work / "refused").mkdir()
random.seed(5)
rows = list(csv.DictReader(open(work / "run.csv")))
frames = [(k / 60,
           345 * float(r["bus32.V_pu"]) * (1 + random.gauss(0, 2e-4)),
           math.degrees(float(r["bus32.theta_rad"]) + random.gauss(0, 1e-4)),
           800 * float(r["32.P_pu"]) + random.gauss(0, 0.1),
           800 * float(r["32.Q_pu"]) + random.gauss(0, 0.1)) for k, r in enumerate(rows)]
begin = datetime.datetime(2026, 3, 13, 12, 56, 20)

def values(f):
    return [f"{x:.6f}" for x in f[1:]]
def write(name, heading, stamp, separator=",", before="", frames=frames, values=values, folder="read"):
    lines = [separator.join([heading, "V_kV", "theta_deg", "P_MW", "Q_Mvar"])]
    lines += [separator.join([stamp(f[0]), *values(f)]) for f in frames]
    (work / folder / name).write_text(before + "\n".join(lines) + "\n")
def clock(form):
    return lambda t: (begin + datetime.timedelta(seconds=t)).strftime(form)[:-3]  # milliseconds

write("plain.csv", "t_s", lambda t: f"{t:.6f}")
for unit, size in {"ms": 1e-3, "msec": 1e-3, "milliseconds": 1e-3, "us": 1e-6, "µs": 1e-6, "ns": 1e-9, "min": 60, "minutes": 60,
                   "h": 3600, "hours": 3600, "cycles": 1 / 60, "sec": 1, "seconds": 1}.items():
    write(f"unit-{unit}.csv", f"Time ({unit})", lambda t, size=size: f"{t / size:.9f}")
for heading in "Seconds", "Zeit [s]", "Temps (s)", "Tiempo (s)", "Time, s":
    write(f"heading-{heading.split()[0]}{len(heading)}.csv", f'"{heading}"', lambda t: f"{t:.6f}")
epoch = begin.replace(tzinfo=datetime.timezone.utc).timestamp()
for name, scale in {"s": 1, "ms": 1e3, "us": 1e6, "ns": 1e9}.items():
    write(f"epoch-{name}.csv", "timestamp", lambda t, scale=scale: f"{(epoch + t) * scale:.{3 if scale == 1 else 0}f}")
days = (begin - datetime.datetime(1899, 12, 30)).total_seconds() / 86400
write("serial-days.csv", "time", lambda t: f"{days + t / 86400:.9f}")
write("stamp-compact.csv", "time", clock("%Y%m%d %H%M%S.%f"))
write("stamp-colon-ms.csv", "time", clock("%Y-%m-%d %H:%M:%S:%f"))
write("stamp-english.csv", "time", clock("%d-%b-%Y %H:%M:%S.%f"))
write("stamp-month-first.csv", "time", lambda t: clock("%b %d %Y %H:%M:%S.%f")(t) + " PM")
for name, month in {"german": "Mrz", "french": "mars", "spanish": "mar", "portuguese": "mar", "italian": "mar", "russian": "мар"}.items():
    write(f"stamp-{name}.csv", "time", lambda t, month=month: f"13-{month}-2026 " + clock("%H:%M:%S.%f")(t))
write("fracsec.csv", "SOC,FRACSEC", lambda t: f"{epoch + math.floor(t):.0f},{round((t % 1) * 1e6)}")
write("comma.csv", "t_s", lambda t: f"{t:.6f}".replace(".", ","), ";", values=lambda f: [x.replace(".", ",") for x in values(f)])
write("before-heading.csv", "t_s", lambda t: f"{t:.6f}", before="PMU report;;;\nAverage;345,99\n")
write("quoted.csv", "t_s", lambda t: f"{t:.6f}", values=lambda f: [f'"{x:,.6f}"' for x in f[1:]])
no_value = lambda f: ["Non un numero"] * 4 if 300 <= round(f[0] * 60) < 303 else values(f)
write("no-value.csv", "t_s", lambda t: f"{t:.6f}", values=no_value)
write("zeros.csv", "t_s", lambda t: f"{t:.6f}", values=lambda f: ["0.000"] * 4 if 300 <= round(f[0] * 60) < 302 else values(f))
write("repeated-end.csv", "t_s", lambda t: f"{t:.6f}", frames=[*frames, frames[-1]])
ragged = (frames[-1][0] + 0.0208, *frames[-1][1:])
write("ragged-end.csv", "t_s", lambda t: f"{t:.6f}", frames=[*frames, ragged])

with open(work / "read" / "phases.csv", "w") as out:  # V and I of each phase, in V, A and degrees
    out.write("time," + ",".join(f"{q}{p}_{x}" for q in "VI" for p in "abc" for x in ("mag", "Ang")) + "\n")
    for t, V, theta, P, Q in frames:
        voltage = cmath.rect(V / math.sqrt(3) * 1e3, math.radians(theta))
        current = (complex(P, Q) * 1e6 / (3 * voltage)).conjugate()
        out.write(clock("%Y-%m-%d %H:%M:%S.%f")(t) + "".join(
            f",{abs(q):.6f},{math.remainder(math.degrees(cmath.phase(q)) - 120 * k, 360):.6f}" for q in (voltage, current) for k in range(3)) + "\n")

scale = [0.02, 0.006, 0.08, 0.08]
def comtrade(name, year, date, data="ASCII", multiplier=True, announced=0, wrapped=False, cut=0):
    tail = ",1,1,P" if year else ""
    channels = [f"{k + 1},{n},,,{u},{scale[k]},0,0,-32767,32767{tail}" for k, (n, u) in
                enumerate([("V_kV", "kV"), ("theta", "deg"), ("P", "MW"), ("Q", "Mvar")])]
    start = f"{date},12:56:20.000000"
    lines = [f"NORTH,PMU 7{',' + year if year else ''}", "4,4A,0D", *channels, "60", "1", f"60,{announced or len(frames)}", start, start, data]
    (work / "read" / f"{name}.cfg").write_text("\r\n".join(lines + (["1"] if multiplier else [])) + "\r\n")
    samples = [(k + 1, round(f[0] * 1e6) % (2 ** 32 if not wrapped else 5_000_000), *[round(x / s) for x, s in zip(f[1:], scale)])
               for k, f in enumerate(frames)]
    text = "".join(",".join(map(str, s)) + "\r\n" for s in samples).encode()
    binary = b"".join(struct.pack("<II4h", *s) for s in samples)
    whole = text if data == "ASCII" else binary
    (work / "read" / f"{name}.dat").write_bytes(whole[:len(whole) - cut])
comtrade("c1991", "", "03/13/26", multiplier=False)
comtrade("c1999", "1999", "13/03/2026")
comtrade("c1999-no-multiplier", "1999", "13/03/2026", multiplier=False)
comtrade("c1999-more", "1999", "13/03/2026", announced=len(frames) - 20)
comtrade("c1999-cut", "1999", "13/03/2026", "BINARY", cut=7)

write("minutes-shown.csv", "time", lambda t: (begin + datetime.timedelta(seconds=t)).strftime("%M:%S.0"), folder="refused")
write("few-digits.csv", "timestamp", lambda t: "1.77237E+12", folder="refused")
write("unit-unknown.csv", "Time (ticks)", lambda t: f"{t:.6f}", folder="refused")
write("short.csv", "t_s", lambda t: f"{t:.6f}", frames=frames[:3], folder="refused")
(work / "refused" / "tall.csv").write_text("timestamp,signal,value\n" + "".join(
    f"{clock('%Y-%m-%d %H:%M:%S.%f')(f[0])},{n},{x}\n" for f in frames[:200] for n, x in zip(("V_kV", "theta_deg", "P_MW", "Q_Mvar"), values(f))))
(work / "refused" / "zip.csv").write_bytes(b"PK\x03\x04" + bytes(60))
(work / "refused" / "status.cfg").write_text("NORTH,PMU 7,1999\n2,0A,2D\n1,A,,,0\n2,B,,,0\n60\n1\n60,2\n13/03/2026,12:56:20.0\n13/03/2026,12:56:20.0\nASCII\n1\n")
(work / "refused" / "status.dat").write_text("1,0,0,0\n2,16667,0,0\n")
PY

# Read: the errors of P and Q equal the plain record's, up to COMTRADE's quantisation and lost frames.
status=0
"$swingbank" compare --model "$work/plant.toml" --records "$work"/read/*.csv "$work"/read/*.cfg --out "$work/out" >"$work/said" 2>&1 ||
  status=$?
((status == 0)) || fail "exit code $status: $(grep -vE '^[PQ] ' "$work/said" | head -40)"
python3 - "$work/out/compare.json" <<'PY' || fail "not compared as the plain record"
import json, sys
events = json.load(open(sys.argv[1]))["events"]
def rms(event):
    return [next(b["rms_pu"] for b in c["map"] if b["band"] == "all" and b["window"] == w) for c in event["channels"] if c["judged"] for w in ("pre-event", "1–5 s after")]
plain = rms(next(e for e in events if e["record"].endswith("plain.csv")))
wrong = [(e["record"], rms(e)) for e in events if any(abs(a - b) > 3e-4 for a, b in zip(rms(e), plain))]
for record, r in wrong:
    print(record, r, "in place of", plain, file=sys.stderr)
exit(bool(wrong))
PY

# refused NAME PATTERN: the record is refused with one message
refused() {
  refuses "$1" "$2" "$swingbank" compare --model "$work/plant.toml" --records "$work/refused/$1" --out "$work/refused-out"
  [[ ! -e $work/refused-out ]] || fail "$1 leaves a folder"
}
refused minutes-shown.csv 'mm:ss.0'
refused few-digits.csv 'digits'
refused unit-unknown.csv 'ticks'
refused short.csv 'at least 30'
refused tall.csv 'one measurement per line|column for each'
refused zip.csv 'zip'
refused status.cfg 'no analogue channel'
