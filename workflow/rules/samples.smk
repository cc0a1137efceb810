"""Shapes drawn from a model, and the validation shapes as it reconstructs them; and both with fewer faces.

Inputs: a trained generator and what it learned from; samples. Output: a folder of surfaces (.ply) and solids
(.vtu) with and without smoothing, each with a certificate of its quality; surfaces alone for models without a
grid.
"""


rule sample_model:
    input:
        unpack(model_fields),
        unpack(trained_model),
    output:
        samples=directory("<results>/samples/{category}/{model}/{seed}/{mode}"),
    log:
        "<logs>/sample_model/{category}/{model}/{seed}/{mode}.log",
    benchmark:
        "<benchmarks>/sample_model/{category}/{model}/{seed}/{mode}.tsv"
    wildcard_constraints:
        model=one_of(TRAINED),
    conda:
        "../envs/tetgan.yaml"
    threads: 1
    resources:
        mem_mb=3000,
    params:
        model=subpath(input.weights, parent=True),
        shapes=config["samples"]["count"],
        meshing=meshing_options,
        code=code_digest("tetgan.models.samples:sample_model", of_model=True),
    shell:
        "tetgan sample {params.model:q} {output.samples:q} --index {input.index:q} --count {params.shapes}"
        " --mode {wildcards.mode} --options {params.meshing:q} --seed {wildcards.seed} --threads {threads}"
        " >{log:q} 2>&1"


rule simplify_samples:
    input:
        samples=simplified_samples,
    output:
        samples=directory("<results>/samples/{category}/{model}/{seed}/{mode}"),
    log:
        "<logs>/simplify_samples/{category}/{model}/{seed}/{mode}.log",
    benchmark:
        "<benchmarks>/simplify_samples/{category}/{model}/{seed}/{mode}.tsv"
    wildcard_constraints:
        model=one_of(SIMPLIFIED),
    conda:
        "../envs/tetgan.yaml"
    threads: 1
    resources:
        mem_mb=1500,
    params:
        faces=lambda wildcards: SETTINGS.models[wildcards.model].faces,
        code=code_digest("tetgan.meshing.simplify:simplify_samples"),
    shell:
        "tetgan simplify {input.samples:q} {output.samples:q} --faces {params.faces} >{log:q} 2>&1"
