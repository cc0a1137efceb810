"""Training: one generator a model and seed, and the one classifier whose features FID and KID compare.

Inputs: fields, points or voxels of a category; point clouds of every category. Outputs: weights, the options used, a log.
A killed training resumes from its checkpoint, which is beside the outputs and is none of them.
"""


rule train_model:
    input:
        unpack(training_inputs),
    output:
        weights="<results>/models/{category}/{model}/{seed}/weights.safetensors",
        options="<results>/models/{category}/{model}/{seed}/options.json",
    log:
        "<logs>/train_model/{category}/{model}/{seed}.log",
    benchmark:
        "<benchmarks>/train_model/{category}/{model}/{seed}.tsv"
    wildcard_constraints:
        model=one_of(TRAINED),
    priority: 1  # the longest jobs start first
    conda:
        "../envs/tetgan.yaml"
    threads: training_threads
    resources:
        mem_mb=training_mem_mb,
        gpu=0,  # a profile grants them; several share the batches of a TetGAN
    params:
        folder=subpath(output.weights, parent=True),
        model=model_options,
        training=training_options,
        of=standing_on,
        code=code_digest("tetgan.training.run:train_model", of_model=True),
    shell:
        "tetgan train {input.index:q} {params.folder:q} --model {params.model:q}"
        " --training {params.training:q} --seed {wildcards.seed} --threads {threads}"
        " --processes {resources.gpu} {params.of}"
        " >{log:q} 2>&1"


rule train_extractor:
    input:
        clouds=expand("<results>/clouds/{category}.npz", category=config["sources"]),
    output:
        weights="<results>/extractor/weights.safetensors",
        options="<results>/extractor/options.json",
    log:
        "<logs>/train_extractor.log",
    benchmark:
        "<benchmarks>/train_extractor.tsv"
    conda:
        "../envs/tetgan.yaml"
    threads: training_threads
    resources:
        mem_mb=5000,
    params:
        folder=subpath(output.weights, parent=True),
        options=section("extractor"),
        code=code_digest("tetgan.evaluation.extractor:train_extractor"),
    shell:
        "tetgan train-extractor {input.clouds:q} {params.folder:q} --options {params.options:q}"
        " --threads {threads} >{log:q} 2>&1"
