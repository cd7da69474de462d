"""Writes a PSS/E case of this repository (.raw of version 33, .dyr of GENROU, SEXS and TGOV1) as PSLF's .epc and .dyd.

    python3 raw_to_pslf.py CASE.raw CASE.dyr OUT.epc OUT.dyd

Numbers are copied as text, so that both pairs of files are the same case. Only quotients are computed, where one format
has per unit and the other has MW and Mvar. Impedances must be per unit (CW = CZ = CM = 1).
"""

import sys
from fractions import Fraction


def sections(path):
    """The header's fields, and the rows of each section as lists of texts."""
    lines = open(path).read().splitlines()
    found, rows = [], []
    for line in lines[3:]:
        fields = [f.strip().strip("'").strip() for f in line.split("/")[0].split(",")]
        if fields == ["0"]:
            found.append(rows)
            rows = []
        elif fields[0] == "Q":
            break
        else:
            rows.append(fields)
    return [f.strip() for f in lines[0].split(",")], found


def per(text, base):
    """Returns text / base as a text that reads back to the nearest double."""
    return repr(float(Fraction(text) / Fraction(base)))


def write_epc(raw, path):
    head, (buses, loads, shunts, generators, branches, windings, *rest) = sections(raw)
    base = head[1]
    held = {g[0]: g[6] for g in generators}
    at = {b[0]: f'{b[0]} "{b[1]:<12}" {b[2]}' for b in buses}
    kinds = {"1": 1, "2": 2, "3": 0}
    none = '-1 "            " 0.0'
    owners = "1 1.000" + "   0 0.000" * 7
    out = [f"title\nfirst line\nsecond line\n!\ncomments\nof no account\n!\nsolution parameters\nsbase {base}\n!"]
    out.append(f"bus data  [{len(buses)}]  ty vsched volt angle ar zone vmax vmin date_in date_out pid L own st")
    for b in buses:
        out.append(f"{at[b[0]]} : {kinds[b[3]]} {held.get(b[0], b[7])} {b[7]} {b[8]} {b[4]} {b[5]} 1.1 0.9 400101 391231 0 0 {b[6]} 0")
    out.append(f"branch data  [{len(branches)}]  ck se long_id st resist react charge")
    for r in branches:
        assert all(float(v) == 0 for v in r[9:13])
        out.append(f'{at[r[0]]} {at[r[1]]} "{r[2]} " 1 "  " : {r[13]} {r[3]} {r[4]} {r[5]} 0 0 0 0 0.0 1.0 /')
        out.append(f" 1 1 0.0 0.0 1.0 400101 391231 0 1 0 0 0 0 0 {owners} 0 0")
    out.append(f"transformer data  [{len(windings) // 4}]  ck long_id st ty")
    for first, z, w1, w2 in zip(*[iter(windings)] * 4):
        assert first[4:7] == ["1", "1", "1"] and float(w2[0]) == 1
        a, b = at[first[0]].split()[-1], at[first[1]].split()[-1]
        out.append(f'{at[first[0]]} {at[first[1]]} "{first[3]} " "  " : {first[11]} 1 {none} 0 {none} {none} 1 1 {base} {z[0]} {z[1]} 0 0 0 0 /')
        out.append(f" {a} {b} 0.0 {w1[2]} {first[7]} {first[8]} 0 0 0 0 0.0 1.5 0.5 1.5 0.5 0.00625 {w1[0]} 1.0 1.0 0.0 400101 391231 0 1 0 0 0 0 /")
        out.append(f" {owners} 0 /\n 0.0 0.0 0.0 0.0 0 0 0 0 0 0 0.0 0.0 0 0 0 0.0 0.0 0")
    out.append(f"generator data  [{len(generators)}]  id long_id st no reg_name prf qrf ar zone pgen pmax pmin qgen qmax qmin mbase")
    for g in generators:
        assert g[7] == "0"
        out.append(f'{at[g[0]]} "{g[1]} " "  " : {g[14]} {at[g[0]]} 0.0 1.0 1 1 {g[2]} 9999 0 {g[3]} {g[4]} {g[5]} {g[8]} 0.0 0.0 {g[9]} {g[10]} {none} {none} 400101 391231 0 0 /')
        out.append(f" {g[11]} {g[12]} {g[13]} {owners} 0 0 0 0 0 0 0 0.0 0 0 1.0")
    out.append(f"load data  [{len(loads)}]  id long_id st mw mvar mw_i mvar_i mw_z mvar_z ar zone")
    for l in loads:
        minus = repr(-float(l[10])) if float(l[10]) else "0"
        out.append(f'{at[l[0]]} "{l[1]} " "  " : {l[2]} {" ".join(l[5:10])} {minus} {l[3]} {l[4]} 400101 391231 0 0 {l[11]} 0')
    out.append(f"shunt data  [{len(shunts)}]  id ck se long_id st ar zone pu_mw pu_mvar")
    for s in shunts:
        out.append(f'{at[s[0]]} "{s[1]} " 0 "            " 0.0 "  " 0 "  " : {s[2]} 1 1 {per(s[3], base)} {per(s[4], base)} 400101 391231 0 0')
    out.append("svd data  [0]\narea data  [1]\n 1 \"area\" 0 0.0 1.0 0.0 0.0\nend")
    open(path, "w").write("\n".join(out) + "\n")


COLUMNS = {
    "GENROU": ("genrou", "tpdo tppdo tpqo tppqo h d ld lq lpd lpq lppd ll s1 s12"),
}


def write_dyd(raw, dyr, path):
    _, found = sections(raw)
    names = {b[0]: (b[1], b[2]) for b in found[0]}
    bases = {(g[0], g[1]): (g[8], g[9]) for g in found[3]}
    out = ["# of no account", "models"]
    for record in open(dyr).read().split("/")[:-1]:
        bus, model, unit, *values = record.replace("'", " ").split()
        pslf, columns = COLUMNS[model]
        mva, ra = bases[(bus, unit)]
        named = " ".join(f'"{c}" {v}' for c, v in zip(columns.split(), values, strict=True))
        out.append(f'{pslf} {bus} "{names[bus][0]:<12}" {names[bus][1]} "{unit} " : #9 mva={mva} {named} /')
        out.append(f' "ra" {ra} "rcomp" 0.0 "xcomp" 0.0 "accel" 0.5')
    open(path, "w").write("\n".join(out) + "\n")


write_epc(sys.argv[1], sys.argv[3])
write_dyd(sys.argv[1], sys.argv[2], sys.argv[4])
