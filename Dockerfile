# The workflow with everything it needs:
#   docker build -t trackroller .
#   docker run --rm --user "$(id -u):$(id -g)" -v "$PWD":/work trackroller --cores all --config study=study.yaml
FROM python:3.11-slim
# a home and a name for any user, as with `docker run --user`; Snakemake, numba and Matplotlib need both
ENV HOME=/opt/trackroller/home
ENV USER=trackroller
ENV NUMBA_CACHE_DIR=/opt/trackroller/home/numba
ENV MPLCONFIGDIR=/opt/trackroller/home/matplotlib
COPY requirements.lock /opt/trackroller/requirements.lock
RUN pip install --no-cache-dir --require-hashes -r /opt/trackroller/requirements.lock
COPY pyproject.toml README.md LICENSE Snakefile /opt/trackroller/
COPY trackroller /opt/trackroller/trackroller
COPY workflow /opt/trackroller/workflow
COPY config /opt/trackroller/config
COPY profiles /opt/trackroller/profiles
RUN pip install --no-cache-dir --no-deps --no-build-isolation -e /opt/trackroller
RUN python -c "import trackroller as tr; tr.solve(tr.Case(), outputs=('friction_work', 'life', 'tractions', 'subsurface'))"
RUN chmod -R a+rwX /opt/trackroller/home
WORKDIR /work
ENTRYPOINT ["snakemake", "--snakefile", "/opt/trackroller/Snakefile"]
CMD ["--cores", "all"]
