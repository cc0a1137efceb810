"""Shapes drawn from a model, and the validation shapes as it reconstructs them.

Inputs: a trained generator, the fields. Output: a folder of surfaces (.ply) and solids (.vtu) with and
without smoothing, each with a certificate of its quality.
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
    conda:
        "../envs/tetgan.yaml"
    threads: 1
    resources:
        mem_mb=3000,
    params:
        model=subpath(input.weights, parent=True),
        shapes=config["sampling"]["count"],
        meshing=meshing_options,
        code=stage_digest("meshing", "nn", "models"),
    shell:
        "tetgan sample {params.model:q} {input.index:q} {output.samples:q} --count {params.shapes}"
        " --mode {wildcards.mode} --options {params.meshing:q} --seed {wildcards.seed} >{log:q} 2>&1"
