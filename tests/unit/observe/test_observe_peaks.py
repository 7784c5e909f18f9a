import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from refusals import refusals

from granular_response.observe.peaks import (
    asymmetry,
    central_dip,
    find_peaks,
    is_double_peaked,
    third_peak,
)

X = np.arange(-10.0, 11.0, 2.0)


def profile(*right):
    """Symmetric profile from its values at x = 0, 2, 4, ...; zero further out."""
    half = np.zeros(6)
    half[: len(right)] = right
    return np.concatenate([half[:0:-1], half])


ONE = profile(1.0, 0.8, 0.4, 0.1)
TWO = profile(0.5, 0.7, 1.0, 0.4)
THREE = profile(0.6, 0.5, 1.0, 0.4)


def nearly(r, by):
    """The profile with one of its equal peaks lower by a little."""
    noisy = r.copy()
    noisy[X == 4.0] -= by
    return noisy


HILL = np.array([0.1, 1.0, 0.4, 0.1, 0.5, 0.6, 0.5999])
#: Samples, values, options, and the peaks: positions and prominences.
FOUND = {
    "one": (X, ONE, {}, [0.0], [1.0]),
    "equal ones share the depth of their dip": (X, TWO, {}, [-4.0, 4.0], [0.5, 0.5]),
    "equal but for the noise of a solver": (X, nearly(TWO, 5e-6), {}, [-4.0, 4.0], [0.5, 0.5]),
    "not equal": (X, nearly(TWO, 5.5e-5), {}, [-4.0, 4.0], [1.0, 0.499945]),
    "unequal ones": (
        np.arange(7.0), [0.0, 0.6, 0.2, 1.0, 0.7, 0.8, 0.1], {}, [1.0, 3.0, 5.0], [0.4, 0.9, 0.1],
    ),
    "three": (X, THREE, {}, [-4.0, 0.0, 4.0], [0.5, 0.1, 0.5]),
    "a plateau at its middle": (X, profile(1.0, 1.0, 0.3), {}, [0.0], [1.0]),
    "a plateau aside": (np.arange(6.0), [0.0, 1.0, 1.0, 0.5, 0.4, 0.0], {}, [1.5], [1.0]),
    "none at an end": (np.arange(5.0), [1.0, 0.5, 0.3, 0.2, 0.1], {}, [], []),
    "none on a plateau at an end": (np.arange(5.0), [0.1, 0.5, 0.9, 1.0, 1.0], {}, [], []),
    "an end is higher ground": (np.arange(5.0), [2.0, 1.0, 1.5, 0.2, 0.1], {}, [2.0], [0.5]),
    "a hill that hardly falls towards the end is none": (np.arange(7.0), HILL, {}, [1.0], [0.9]),
    "unless so little counts": (
        np.arange(7.0), HILL[::-1], {"relative_prominence": 1e-5}, [1.0, 5.0], [1e-4, 0.9],
    ),
    "a dip that separates": (
        X, profile(0.995, 1.0, 0.5), {"relative_prominence": 0.004}, [-2.0, 2.0], [0.005, 0.005],
    ),
    "a dip below the threshold": (X, profile(0.995, 1.0, 0.5), {"relative_prominence": 0.006}, [0.0], [1.0]),
    "bumps beside a peak": (X, profile(1.0, 0.5, 0.1, 0.1005), {"relative_prominence": 1e-3}, [0.0], [1.0]),
    "bumps that count": (
        X, profile(1.0, 0.5, 0.1, 0.1005), {"relative_prominence": 1e-4}, [-6.0, 0.0, 6.0], [5e-4, 1.0, 5e-4],
    ),
    "near a wall": (X, np.where(X == -8.0, 3.0, ONE), {}, [-8.0, 0.0], [3.0, 0.9]),
    "in the interior": (X, np.where(X == -8.0, 3.0, ONE), {"interior": np.abs(X) < 7.0}, [0.0], [0.9]),
    "none in zeros": (X, np.zeros(X.size), {}, [], []),
    "none in a constant": (X, np.ones(X.size), {}, [], []),
}  # fmt: skip


@pytest.mark.parametrize(("x", "r", "options", "position", "prominence"), FOUND.values(), ids=FOUND)
def test_peaks_of_a_profile(x, r, options, position, prominence):
    peaks = find_peaks(x, r, **options)
    assert peaks.position.tolist() == position and len(peaks) == len(position)
    assert peaks.prominence == pytest.approx(prominence, abs=1e-5)


@given(st.integers(0, 2**32 - 1), st.sampled_from([ONE, TWO, THREE, profile(1.0, 1.0, 0.3), profile(0.9, 1, 1)]))
def test_rounding_noise_changes_nothing(seed, r):
    noise = 1e-13 * np.random.default_rng(seed).standard_normal(r.size)
    clean, noisy = find_peaks(X, r), find_peaks(X, r + noise)
    np.testing.assert_array_equal(noisy.position, clean.position)
    np.testing.assert_allclose(noisy.height, clean.height, atol=1e-12)
    np.testing.assert_allclose(noisy.prominence, clean.prominence, atol=1e-12)


@given(st.lists(st.floats(-1.0, 1.0), min_size=3, max_size=12), st.booleans())
def test_symmetric_profiles_have_symmetric_peaks(half, centre):
    r = np.array(half[:0:-1] + half if centre else half[::-1] + half)
    x = np.arange(r.size) - 0.5 * (r.size - 1)
    peaks = find_peaks(x, r)
    np.testing.assert_array_equal(peaks.position, -peaks.position[::-1])
    # Ties are broken by sample order, so equal heights agree up to the rounding tolerance only.
    np.testing.assert_allclose(peaks.height, peaks.height[::-1], atol=2e-5)
    np.testing.assert_allclose(peaks.prominence, peaks.prominence[::-1], atol=2e-5)


@given(st.lists(st.integers(-50, 50), min_size=3, max_size=25, unique=True))
def test_distinct_heights_agree_with_scipy(values):
    from scipy import signal  # takes longer to import than these tests take

    r = np.array(values, dtype=float)
    threshold = 0.1 * np.abs(r).max()
    expected, properties = signal.find_peaks(r, prominence=threshold)
    peaks = find_peaks(np.arange(r.size), r, relative_prominence=0.1)
    np.testing.assert_array_equal(peaks.position, expected)
    np.testing.assert_allclose(peaks.prominence, properties["prominences"])


def raised(*places):
    """One peak in the middle, with other values at some places."""
    r = ONE.copy()
    for x, value in places:
        r[x == X] = value
    return r


#: The middle of samples that avoid the axis; a dip of 0.002, and one of 0.0005.
BETWEEN, DIP, SHALLOW = np.arange(-5.0, 6.0, 2.0), profile(0.998, 1.0, 0.5), profile(0.9995, 1.0, 0.5)
DOUBLE = {
    "one": (X, ONE, {}, False),
    "two": (X, TWO, {}, True),
    "one of two in the middle": (X, raised((6.0, 1.5)), {}, False),
    "a lower one at the left": (X, raised((6.0, 1.5), (-6.0, 0.8)), {}, False),
    "a lower one at the right": (X, raised((6.0, 1.5), (-6.0, 0.8))[::-1], {}, False),
    "lower ones beside the middle": (X, profile(1.0, 0.2, 0.6), {}, False),
    "a dip": (X, DIP, {}, True),
    "hardly a dip": (X, SHALLOW, {}, False),
    "the dip that is asked for": (X, DIP, {"relative_prominence": 0.0019}, True),
    "less than the dip that is asked for": (X, DIP, {"relative_prominence": 0.0021}, False),
    "two beside the axis": (BETWEEN, [0.0, 1.0, 0.5, 0.5, 1.0, 0.0], {}, True),
    "a plateau on the axis": (BETWEEN, [0.0, 0.5, 1.0, 1.0, 0.5, 0.0], {}, False),
}


@pytest.mark.parametrize(("x", "r", "options", "double"), DOUBLE.values(), ids=DOUBLE)
def test_two_peaks_are_both_higher_than_the_centre_by_the_stated_dip(x, r, options, double):
    assert is_double_peaked(x, r, **options) is double


def test_third_peak_is_one_between_two():
    assert third_peak(X, THREE) > 0.0
    assert is_double_peaked(X, THREE)
    assert third_peak(X, TWO) == 0.0
    assert third_peak(X, ONE) == 0.0
    assert third_peak(X, profile(1.0, 0.2, 0.6)) == 0.0


def test_central_dip_measures_the_crossover_continuously():
    assert central_dip(X, TWO) == pytest.approx(0.5)
    assert central_dip(X, ONE) == pytest.approx(-0.2)
    lopsided = TWO.copy()
    lopsided[X == 4.0] = 0.8
    assert central_dip(X, lopsided) == pytest.approx(0.3)
    jittered = X.copy()
    jittered[5] = 1e-13
    assert central_dip(jittered, ONE) == pytest.approx(-0.2)


def test_asymmetry():
    assert asymmetry(X, TWO) == 0.0
    lopsided = TWO.copy()
    lopsided[X == 4.0] = 0.8
    assert asymmetry(X, lopsided) == pytest.approx(0.2)
    assert asymmetry(X, lopsided[::-1]) == pytest.approx(0.2)


def test_asymmetry_interpolates_positions_off_the_mirror_and_drops_the_unpaired():
    x = np.array([-4.0, -2.0, 0.5, 2.5, 9.0])
    r = 10.0 - np.abs(x)  # 9 has no counterpart; the others match except 0.5, against 8.9 at -0.5
    assert asymmetry(x, r) == pytest.approx(0.6 / 9.5)


test_bad_samples_are_refused = refusals(
    ValueError,
    (lambda: find_peaks([0.0, 1.0], [1.0, 2.0]), "at least 3"),
    (lambda: find_peaks([0.0, 1.0, 1.0], [1.0, 2.0, 1.0]), "increasing"),
    (lambda: find_peaks([0.0, 1.0, 2.0], [1.0, np.nan, 1.0]), "finite"),
    (lambda: find_peaks([0.0, 1.0, 2.0], [1.0, 2.0]), "shape"),
    (lambda: find_peaks(X, np.ones(X.size), relative_prominence=0.0), r"relative_prominence = 0\.0"),
    (lambda: asymmetry(X, -np.ones(X.size)), "positive"),
)
