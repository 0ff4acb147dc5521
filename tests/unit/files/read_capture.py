"""Reads a capture with nothing but h5py and docs/capture-format.md; prints what it found, a fact a line."""
import hashlib
import struct
import sys
import tomllib

import h5py
import numpy


def text(dataset):
    return dataset.asstr()[()]


def attribute(thing, name):
    return thing.attrs[name].decode()


def channels(raw):
    return [name.decode() for name in raw.attrs["channels"]]


def packed(value):
    raw = value.encode()
    return struct.pack("<I", len(raw)) + raw


def optional(value):
    if value is None:
        return b"\x00"
    return b"\x01" + (packed(value) if isinstance(value, str) else struct.pack("<d", value))


SOLIDS = {
    "three-element": ("E1_Pa", "E2_Pa", "eta2_Pa_s"),
    "two-kelvin": ("E1_Pa", "E2_Pa", "eta2_Pa_s", "E3_Pa", "eta3_Pa_s"),
}


def numbers(values, keys):
    return b"".join(struct.pack("<dd", values[key], values.get(key + "_sd", 0.0)) for key in keys)


def material(values, version):
    solid = values.get("solid", "three-element")
    out = b"\x01" + numbers(values, ("density_kg_m3", "poisson_ratio"))
    out += packed(solid) if version == 4 else b""
    out += numbers(values, SOLIDS[solid])
    out += packed(values.get("source", ""))
    if version > 1:
        covariance, identified = values.get("covariance"), values.get("identified")
        out += struct.pack(f"<B{len(covariance)}d", 1, *covariance) if covariance else b"\x00"
        out += b"\x00" if identified is None else (
            b"\x01" + optional(identified.get("band_limit_Hz")) + optional(identified.get("temperature_K")))
    return out


def reduction(asked):
    out = b""
    for key in ("dispersion", "separate", "stress", "inertia"):
        out += optional(text(asked[key]) if key in asked else None)
    for key in ("friction", "band_limit_Hz", "duration_s"):
        out += optional(float(asked[key][()]) if key in asked else None)
    return out + (b"\x01" if "true" in asked and asked["true"][()] else b"\x00")


def version_of(model, asked):
    if model and "solid" in model:
        return 4
    if asked is not None:
        return 3
    return 2 if model and ("covariance" in model or "identified" in model) else 1


def canonical(entry):
    shot, raw = entry["shot"], entry["raw"]
    model = tomllib.loads(text(shot["bar_model_toml"])) if "bar_model_toml" in shot else None
    version = version_of(model, shot.get("reduction"))
    out = struct.pack("<I", version) + packed(text(shot["id"])) + packed(text(shot["bench_toml"]))
    out += material(model, version) if model else b"\x00"
    out += struct.pack("<B", "reduction" in shot) if version == 4 else b""
    out += reduction(shot["reduction"]) if "reduction" in shot else b""
    for key in ("rate_numerator", "rate_denominator", "first_tick"):
        out += struct.pack("<q", shot[key][()])
    if "trigger_tick" in shot:
        kind = ["incident", "forced", "marked"].index(text(shot["trigger_kind"]))
        out += struct.pack("<BqddB", 1, shot["trigger_tick"][()], shot["trigger_fraction"][()],
                           shot["trigger_sigma_samples"][()], kind)
    else:
        out += b"\x00"
    out += struct.pack("<I", len(shot["gaps"]))
    for tick, samples, known in shot["gaps"][()]:
        out += struct.pack("<qqB", tick, samples, known)
    facts = {attribute(d, "key") if "key" in d.attrs else name: text(d) for name, d in shot["meta"].items()}
    out += struct.pack("<I", len(facts))
    for key in sorted(facts, key=str.encode):
        out += packed(key) + packed(facts[key])
    out += struct.pack("<qq", shot["utc_ns"][()], shot["monotonic_ns"][()])
    out += packed(text(shot["software_version"]))
    out += struct.pack("<I", len(channels(raw)))
    for name in channels(raw):
        codes, a = raw[name], raw[name].attrs
        width = 2 if numpy.all(codes[()] == codes[()].astype("<i2")) else 4
        out += packed(attribute(codes, "gauge")) + packed(attribute(codes, "unit"))
        out += struct.pack("<ddiiiQB", a["scale"], a["offset"], a["bits"], a["code_min"],
                           a["code_max"], len(codes), width)
    return out


with h5py.File(sys.argv[1], "r") as file:
    entry = file[file.attrs["default"]]
    plot = entry[entry.attrs["default"]]
    shot, raw = entry["shot"], entry["raw"]
    for name, thing in (("root", file), ("entry", entry), ("plot", plot), ("raw", raw), ("shot", shot)):
        print(f"{name}.NX_class={thing.attrs['NX_class']}")
    print(f"creator={file.attrs['creator']}")
    print(f"title={text(entry['title'])}")
    print(f"start_time={text(entry['start_time'])}")
    print(f"signal={plot.attrs['signal']}")
    print(f"auxiliary_signals={','.join(plot.attrs['auxiliary_signals'])}")
    print(f"axes={plot.attrs['axes']}")
    time = plot[plot.attrs["axes"]]
    print(f"time.units={time.attrs['units']}")
    print(f"time.first={float(time[0]).hex()}")
    print(f"time.last={float(time[-1]).hex()}")
    for name in channels(raw):
        codes, shown, a = raw[name][()], plot[name], raw[name].attrs
        print(f"{name}.dtype={codes.dtype.str}")
        print(f"{name}.units={shown.attrs['units']}")
        print(f"{name}.long_name={shown.attrs['long_name']}")
        print(f"{name}.codes_sum={int(codes.astype('i8').sum())}")
        print(f"{name}.digest_right={hashlib.sha256(codes.tobytes()).hexdigest() == attribute(raw[name], 'sha256')}")
        values = (codes.astype("f8") + a["offset"]) * a["scale"]
        print(f"{name}.values_right={bool(numpy.array_equal(values, shown[()]))}")
    digest = hashlib.sha256(canonical(entry)).hexdigest()
    print(f"metadata_digest_right={digest == attribute(shot, 'sha256')}")

content = open(sys.argv[1], "rb").read()
image, seal = content[:-95], content[-95:]
expected = b"\nKOLSKY CAPTURE SEAL 1 sha256 " + hashlib.sha256(image).hexdigest().encode() + b"\n"
print(f"seal_right={seal == expected}")
