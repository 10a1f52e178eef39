"""Settings for all tests."""

from hypothesis import settings

# a busy machine must not fail a test: what an example costs is measured in benchmarks/
settings.register_profile("trackroller", deadline=None)
settings.load_profile("trackroller")
